"""What `course-kit class` says of an intake, with a roster or without."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from course_kit.classroom.intake.collecting import Intake
    from course_kit.classroom.intake.roster_matching import Fit

_MOST_NAMED = 20  # in a sentence; the table has them all


def say(found: Intake, tell: Callable[[str], None]) -> None:
    """Tell what somebody should look at."""
    for sentence in _sentences(found):
        tell(sentence)


def _sentences(found: Intake) -> Iterator[str]:
    called = {entry.student: entry.called for entry in (*found.entries, *found.others)}
    doubtful = [f"{entry.called}, {entry.exercise} ({entry.worry})" for entry in found.entries if entry.worry]
    if doubtful:
        yield f"Look at the choice of file in intake.csv: {_some(doubtful)}."
    if found.roster is not None:
        yield from _of_roster(found.roster, called)


def _of_roster(fit: Fit, called: Mapping[str, str]) -> Iterator[str]:
    read_as = ", ".join(f"'{header}' as {kind}" for header, kind in fit.roster.read_as)
    total = len(fit.roster.people)
    yield f"{fit.roster.called}: read {read_as}; {fit.matched} of {total} on it handed something in."
    if fit.absent:
        yield f"Not handed in: {_some([one.name or one.student for one in fit.absent])}."
    if fit.unknown:
        unknown = [f"{called.get(who, who)} ({why})" for who, why in fit.unknown]
        yield f"Not matched with {fit.roster.called}: {_some(unknown)}."


def _some(parts: Sequence[str]) -> str:
    more = len(parts) - _MOST_NAMED
    return ", ".join(parts[:_MOST_NAMED]) + (f", and {more} more" if more > 0 else "")

"""Checks: how a grader declares them, and how they are run one after another.

A check is a function that talks to the submission over the wire and either returns `Evidence` or raises
`Failed`. Its name is the check's id, the first line of its docstring the title.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from course_kit.grading.checks.exchange_log import GRADER
from course_kit.grading.diagnosis import exits
from course_kit.grading.errors import GradingError
from course_kit.grading.model.report import CheckResult
from course_kit.ros.sequence import Arrow

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from course_kit.grading.checks.context import CheckContext


@dataclass(frozen=True)
class Evidence:
    """What was seen on the wire: what we sent, what should come back, and what came."""

    sent: str = ""
    expected: str = ""
    got: str = ""


class Failed(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check was not passed.

    Attributes:
        evidence: what was seen.
        diagnosis: a code of the catalogue when the cause is established, else None.
        message: what happened in this case, in one or two sentences for the learner.
        breaks: the sentence of the exercise that is broken, where the check proves several.
        steps: what crossed the wire; taken from the record of the check when empty.
    """

    def __init__(self, evidence: Evidence, message: str, diagnosis: str | None = None, *, breaks: str = "") -> None:
        super().__init__(message)
        self.evidence = evidence
        self.message = message
        self.diagnosis = diagnosis
        self.breaks = breaks
        self.steps: tuple[Arrow, ...] = ()


class NotRun(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check that makes no sense in this grading; the text tells the learner why."""


@dataclass(frozen=True)
class Check:
    """One thing a submission must do.

    Attributes:
        id: its name in reports.
        title: one line for the learner.
        points: what it is worth.
        depends_on: ids of checks without which it makes no sense; it is skipped unless they passed.
        deadline_s: seconds for all its waiting together.
        run: the function.
        proves: ids of the sentences of the exercise that it proves; they stand in the exercise's exercise.toml.
    """

    id: str
    title: str
    points: float
    depends_on: tuple[str, ...]
    deadline_s: float
    run: Callable[[CheckContext], Evidence]
    proves: tuple[str, ...] = ()


def in_order(checks: Sequence[Check]) -> list[Check]:
    """The checks such that each comes after those it depends on, otherwise as declared."""
    names = [one.id for one in checks]
    if doubles := sorted({name for name in names if names.count(name) > 1}):
        raise ValueError(f"two checks are called {doubles[0]}")
    ordered: list[Check] = []
    waiting = list(checks)
    while waiting:
        done = {one.id for one in ordered}
        following = next((one for one in waiting if set(one.depends_on) <= done), None)
        if following is None:
            unmet = sorted({name for one in waiting for name in one.depends_on} - done)
            raise ValueError(f"these checks are never run because they wait for {', '.join(unmet)}")
        waiting.remove(following)
        ordered.append(following)
    return ordered


def choose_part(checks: Sequence[Check], part: str) -> list[Check]:
    """The checks of one part, whose ids begin with its name (`door`: `door_locked`), and those they depend on."""
    chosen = {one.id for one in checks if f"{one.id}_".startswith(f"{part}_")}
    if not chosen:
        raise GradingError(f"No check begins with '{part}_'. There are: {', '.join(one.id for one in checks)}.")
    for one in reversed(in_order(checks)):
        if one.id in chosen:
            chosen.update(one.depends_on)
    return [one for one in checks if one.id in chosen]


def run_all(checks: Sequence[Check], context: CheckContext) -> Iterator[CheckResult]:
    """Run the checks in order of dependence, yielding each result as soon as it is known."""
    passed: set[str] = set()
    titles = {one.id: one.title for one in checks}
    broken = ""
    for one in in_order(checks):
        if broken:  # then there is no grade
            yield CheckResult(
                one.id, one.title, "skipped", one.points, message=f'Not run: the grader failed in "{broken}".'
            )
            continue
        missing = [name for name in one.depends_on if name not in passed]
        if missing:
            needed = ", ".join(f'"{titles[name]}"' for name in missing)
            yield CheckResult(one.id, one.title, "skipped", one.points, message=f"Not run: {needed} must pass first.")
            continue
        result = replace(_run(one, context), proves=one.proves)
        if result.status == "passed":
            passed.add(one.id)
        elif result.status == "error":
            broken = one.title
        yield result


def _run(one: Check, context: CheckContext) -> CheckResult:
    try:
        context.begin(one.deadline_s)
        seen = one.run(context)
    except Failed as verdict:
        name_lost_node(context, verdict)
        seen = verdict.evidence
        status, diagnosis, message = "failed", verdict.diagnosis, verdict.message
        steps = verdict.steps or _exchange(context, seen)
    except GradingError:
        raise
    except NotRun as reason:
        return CheckResult(one.id, one.title, "skipped", one.points, message=f"Not run: {reason}")
    except Exception as problem:  # noqa: BLE001 - whatever it is, it is our fault and must not cost any points
        text = f"The grader itself failed here ({type(problem).__name__}: {problem}). This is not your fault."
        return CheckResult(one.id, one.title, "error", one.points, message=text)
    else:
        status, diagnosis, message, steps = "passed", None, "", ()
    seen_on_the_wire = (seen.sent, seen.expected, seen.got)
    return CheckResult(one.id, one.title, status, one.points, *seen_on_the_wire, diagnosis, message, steps)


def name_lost_node(context: CheckContext, failed: Failed) -> None:
    """Where a silent program's node has lost its executor, that is the reason."""
    if failed.evidence.got.startswith("no ") and (place := context.program.lost_in()):
        failed.diagnosis = "action.node_lost"
        failed.message = f"A callback spins its own node in {exits.source_line(context.job, place)}."


def _exchange(context: CheckContext, seen: Evidence) -> tuple[Arrow, ...]:
    """The steps that led to a verdict; whatever goes wrong in telling them leaves the verdict as it is."""
    try:
        return context.record.steps(seen)
    except Exception as problem:  # noqa: BLE001 - as above
        return (Arrow(GRADER, GRADER, "note", f"The grader could not tell the exchange ({problem!r})."),)

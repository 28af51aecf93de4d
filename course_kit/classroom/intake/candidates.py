"""Which of a student's files is the submission: by what is in them, then by when they are from; and why, in words."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.classroom.intake.layouts import HandIn
    from course_kit.grading.model.exercise import Exercise

NAMED, CALLED_ALIKE, BY_CONTENT, ONLY_ONE = 4, 3, 2, 1  # how sure it is that a file is for an exercise
_AT_ONCE_S = 60.0  # files that are written by one download or one `git clone` are of one age


def choose_candidate(
    candidates: Sequence[HandIn], exercise: Exercise, files: Sequence[HandIn]
) -> tuple[HandIn, dict[str, str]]:
    """Choose one; with it, by their paths, why each of the others was not chosen."""
    ranks = {candidate.path: _rank(candidate, candidates) for candidate in candidates}
    best, *others = sorted(candidates, key=lambda candidate: ranks[candidate.path], reverse=True)
    reasons = {rival.path: _why_not_chosen(rival, best, _first_difference(ranks, best, rival)) for rival in others}
    why = _fit(best, exercise)
    worries = [best.doubt] if best.doubt and not best.is_starter else []
    if others:
        place = _first_difference(ranks, best, others[0])
        why = f"{_WON[place].format(len(candidates))}; {why}"
        if place == len(_WON) - 1 and _differ(best, others[0]):
            worries.append(f"only its name was better than that of {others[0].path}")
    asked_for = [rival.path for rival in others if rival.found and not rival.is_starter]
    if asked_for and not best.found and not best.problem:
        worries.append(f"{asked_for[0]} holds {exercise.asks_for}, and this one does not")
    if not (best.item.is_program or exercise.files):
        worries.append("it is neither a .py nor an .ipynb file")
    if best.is_starter:
        why = f"{why}; it is the starter, unchanged"
        worries.append("it is the starter, unchanged")
    if beside := _find_imported_module(best, files):
        why = f"{why}; it imports {beside}, and only one file is graded"
        worries.append(f"it imports {beside}, and only one file is graded")
    return replace(best, why=why, worry="; ".join(worries)), reasons


Rank = tuple[bool, bool, tuple[int, ...], bool, int, str]
_WON = (
    "the only one of {} files that differs from the starter",
    "the one of {} files that has what the exercise asks for",
    "the last upload of {} files",
    "the newest of {} files",
    "the one of {} equally old files with the best name",
    "the last by its name of {} files that differ in nothing else",
)
_LOST = (
    "the starter, unchanged",
    "it does not contain what the exercise asks for",
    "an earlier upload",
    "older",
    "of the same age; its name fits less",
    "of the same age, and its name comes first",
)


def _rank(pick: HandIn, candidates: Sequence[HandIn]) -> Rank:
    """What speaks for a file, the most important first. One that cannot be had is not replaced by an older one."""
    lost = bool(pick.problem)
    rivals = [other.changed for other in candidates if (other.is_starter, other.fits) == (pick.is_starter, pick.fits)]
    is_new = lost or pick.changed >= max(rivals) - _AT_ONCE_S
    return (
        not pick.is_starter,
        lost or pick.fits,
        pick.attempt,
        is_new,
        pick.sureness,
        pick.path,
    )


def _first_difference(ranks: dict[str, Rank], first: HandIn, other: HandIn) -> int:
    pairs = zip(ranks[first.path], ranks[other.path], strict=True)
    return next((place for place, (ours, another) in enumerate(pairs) if ours != another), len(_WON) - 1)


def _differ(candidate: HandIn, other: HandIn) -> bool:
    """Whether two files hold different programs, as far as anybody can tell."""
    return not candidate.identity or candidate.identity != other.identity


def _why_not_chosen(candidate: HandIn, best: HandIn, place: int) -> str:
    if candidate.problem:
        return candidate.problem
    if not _differ(candidate, best):
        return "the same program"
    return "the starter, unchanged" if candidate.is_starter else _LOST[place]


def _fit(candidate: HandIn, exercise: Exercise) -> str:
    """Why a file is taken to be for an exercise."""
    if candidate.sureness == NAMED:
        return "same name as the starter"
    if candidate.sureness == CALLED_ALIKE:
        return "the exercise's name is in its name"
    if candidate.sureness == BY_CONTENT:
        return f"it holds {exercise.asks_for}"
    return "the only program" if candidate.item.is_program else "the only file"


def _find_imported_module(candidate: HandIn, files: Sequence[HandIn]) -> str:
    """A module beside the file that it imports; the sandbox has one file alone."""
    beside = {
        file.file_name.removesuffix(".py"): file.file_name
        for file in files
        if file.path != candidate.path and file.folder == candidate.folder and file.file_name.endswith(".py")
    }
    return ", ".join(sorted(one_line(beside[name]) for name in candidate.imports & beside.keys()))

"""Proves that a student edition holds no answer: grades every program in it, and compares with the starters.

The programs are graded side by side with the machinery of a class. A starter's own score is the measure; what scores
more is a finding, and so is a starter that reaches the pass mark.
"""

from __future__ import annotations

import tempfile
import time
from concurrent.futures import as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from course_kit.authoring import candidates
from course_kit.authoring.candidates import Candidate, Wanted
from course_kit.classroom.executors import Local
from course_kit.grading import exercise, needs
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.grading.workers.pool import Task

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.classroom.executors import Executor
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.submission import Submission

_DRAWS = 12  # seeds with which answers are marked: each draws other scenarios
_SEED = 1  # of what the checks draw elsewhere; the same for all, so that scores can be compared
_TINY = 1e-6  # points


class Watcher(Protocol):
    """Told how the proof goes."""

    def begin(self, programs: int) -> None:
        """So many programs were found."""

    def done(self) -> None:
        """One of them was graded."""

    def end(self) -> None:
        """All were graded, or the proof was given up."""


@dataclass(frozen=True)
class Finding:
    """A program that an edition must not hold."""

    candidate: Candidate
    score: float
    starter: float
    points: float


@dataclass(frozen=True)
class EditionProof:
    """What was graded and what was found.

    Attributes:
        programs: how many programs were graded, the starters not counted.
        findings: those that score more than they may.
        duration_s: seconds on the wall.
    """

    programs: int
    findings: tuple[Finding, ...]
    duration_s: float


def prove(edition: Path, exercises: Sequence[str], solutions: Path, watcher: Watcher) -> EditionProof:
    """Grade every program in a student edition.

    Args:
        edition: its folder.
        exercises: the ids of its exercises.
        solutions: the folder with their solutions, which say what to look for; it need not be there.
        watcher: told how it goes.

    Raises:
        GradingError: something cannot be graded here, so that nothing is proven.
    """
    began = time.monotonic()
    tasks = {name: exercise.load(name, edition / "exercises") for name in exercises}
    for task in tasks.values():
        needs.require(task.limits)
    starters = [starter for task in tasks.values() for starter in _starters(task)]
    wanted = [Wanted(task, _starters(task)[0].source, _solution(task, solutions)) for task in tasks.values()]
    found = candidates.find(edition, wanted, frozenset(one.source.strip() for one in starters))
    watcher.begin(len(found))
    executor = Local(graders=[task.grader for task in tasks.values()])
    try:
        scores = _grade(executor, tasks, starters, watcher=None)
        most = {name: max(scores[one] for one in starters if one.exercise == name) for name in tasks}
        scores |= _grade(executor, tasks, found, watcher)
        if any(scores[one] > most[one.exercise] + _TINY for one in found):
            again = _grade(executor, tasks, starters, watcher=None)  # a busy machine may have cost them points
            most = {name: max(most[name], *(again[one] for one in starters if one.exercise == name)) for name in tasks}
    finally:
        executor.close()
        watcher.end()
    findings = [
        Finding(one, scores[one], most[one.exercise], tasks[one.exercise].points)
        for one in (*starters, *found)
        if scores[one] > most[one.exercise] + _TINY
        or (one in starters and scores[one] >= tasks[one.exercise].pass_mark)
    ]
    return EditionProof(len(found), tuple(findings), time.monotonic() - began)


def _starters(task: Exercise) -> list[Candidate]:
    """The starter of an exercise as a program, and as its notebook has it."""
    files = [task.folder / task.starter, task.folder / task.notebook]
    return [
        Candidate(task.id, source, f"exercises/{task.id}/{file.name}", "the starter")
        for file, source in zip(files, _read_sources(files, task), strict=True)
    ]


def _read_sources(files: Iterable[Path], task: Exercise) -> list[str]:
    with Reader() as reader:
        try:
            return [_read(reader, file, task).source for file in files]
        except UnreadableError as problem:
            raise GradingError(f"A starter of {task.id} cannot be graded: {problem}") from None


def _read(reader: Reader, file: Path, task: Exercise) -> Submission:
    with Copy(file) as copy:
        return reader.read(copy, task)


def _solution(task: Exercise, solutions: Path) -> str:
    try:
        return (solutions / task.id / f"{task.id}.py").read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""


def _grade(
    executor: Executor, tasks: dict[str, Exercise], programs: Sequence[Candidate], watcher: Watcher | None
) -> dict[Candidate, float]:
    """The best score of each program.

    Raises:
        GradingError: one could not be graded, through no fault of its own.
    """
    waiting = {}
    for program, text in _submissions(tasks, programs):
        for seed in _seeds(tasks[program.exercise]):
            task = Task(tasks[program.exercise], text, program.file, seed)
            waiting[executor.submit(task)] = program
    left = dict.fromkeys(programs, 0)
    for program in waiting.values():
        left[program] += 1
    scores = dict.fromkeys(programs, 0.0)
    for future in as_completed(waiting):
        program = waiting[future]
        report = future.result()
        if report.status == "error":
            raise GradingError(
                f"Nothing is proven, because {program.file} ({program.place}) could not be graded as "
                f"{program.exercise}: {report.problem} Run this again."
            )
        scores[program] = max(scores[program], report.score)
        left[program] -= 1
        if watcher is not None and not left[program]:
            watcher.done()
    return scores


def _seeds(task: Exercise) -> Sequence[int]:
    if not task.variable:
        return (_SEED,)
    return range(_DRAWS) if task.seed is None else dict.fromkeys((task.seed, *range(_DRAWS)))  # type: ignore[return-value]


def _submissions(tasks: dict[str, Exercise], programs: Sequence[Candidate]) -> list[tuple[Candidate, Submission]]:
    """The programs as the graders take them; those that no grader would take score nothing."""
    found = []
    with tempfile.TemporaryDirectory(prefix="course-kit-release-") as folder, Reader() as reader:
        file = Path(folder) / "program.py"
        for program in programs:
            file.write_text(program.source, encoding="utf-8", errors="replace")
            try:
                found.append((program, _read(reader, file, tasks[program.exercise])))
            except UnreadableError:
                continue
    return found

"""Proves that a student edition holds no answer: grades every program in it, and compares with the starters.

The programs are graded side by side with the machinery of a class. A starter's own score is the measure; what scores
more is a finding, and so is a starter that passes: then somebody has kept a solution as the pristine copy.
"""

from __future__ import annotations

import tempfile
import time
from collections import Counter
from concurrent.futures import as_completed
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from course_kit.authoring import edition_programs
from course_kit.authoring.edition_programs import EditionProgram, ExerciseClues
from course_kit.classroom.executors import Local
from course_kit.grading import exercise, exercise_folders, needs
from course_kit.grading.engine import Task
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from course_kit.classroom.executors import Executor
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.submission import Submission

_DRAWS = 12  # seeds with which answers are marked: each draws other scenarios
_SEED = 1  # of what the checks draw elsewhere; the same for all, so that scores can be compared
_TINY = 1e-6  # points
_TRIES = 2  # of a grading that fails by itself, as on a busy machine


class ProofWatcher(Protocol):
    """Told how the proof goes."""

    def begin(self, programs: int) -> None:
        """So many programs were found."""

    def done(self) -> None:
        """One of them was graded."""

    def end(self) -> None:
        """All were graded, or the proof was given up."""


@dataclass(frozen=True)
class ProofFinding:
    """A program that an edition must not hold."""

    candidate: EditionProgram
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
    findings: tuple[ProofFinding, ...]
    duration_s: float


def prove(edition: Path, solutions: Mapping[str, Path], watcher: ProofWatcher) -> EditionProof:
    """Grade every program in a student edition.

    Args:
        edition: its folder.
        solutions: by the ids of its exercises their solutions, which say what to look for; they need not be there.
        watcher: told how it goes.

    Raises:
        GradingError: something cannot be graded here, so that nothing is proven.
    """
    began = time.monotonic()
    tasks = {name: exercise.load(name, edition / "exercises") for name in solutions}
    for task in tasks.values():
        needs.require(task.limits)
    starters = {name: _starters(task) for name, task in tasks.items()}
    wanted = [ExerciseClues(task, starters[name][0].source, _solution(solutions[name])) for name, task in tasks.items()]
    known = {one.program for pair in starters.values() for one in pair}
    found = [one for one in edition_programs.find(edition, wanted) if one.program not in known]
    watcher.begin(len({one.program for one in found}))
    executor = Local(None, [task.grader for task in tasks.values()], [task.limits for task in tasks.values()])
    try:
        findings = _compare(_Grading(executor, tasks, watcher), starters, found)
    finally:
        executor.close()
        watcher.end()
    return EditionProof(len({one.program for one in found}), tuple(findings), time.monotonic() - began)


def _compare(
    grading: _Grading, starters: Mapping[str, list[EditionProgram]], found: Sequence[EditionProgram]
) -> list[ProofFinding]:
    """The programs that score more than the starters of their exercise, and starters that do, or that pass."""
    every_starter = [one for pair in starters.values() for one in pair]
    of_starters = grading.scores(every_starter, counted=False)
    of_found = grading.scores(found)

    def findings() -> list[ProofFinding]:
        scores = {**of_found, **of_starters}
        # The program and the notebook are the same starter: if one of them scores more, somebody has worked on it.
        most = {name: min(of_starters[one.program] for one in pair) for name, pair in starters.items()}
        return [
            ProofFinding(one, scores[one.program], most[one.exercise], grading.tasks[one.exercise].points)
            for one in (*every_starter, *found)
            if scores[one.program] > most[one.exercise] + _TINY
            or (one in every_starter and scores[one.program] >= grading.tasks[one.exercise].pass_mark)
        ]

    if not findings():
        return []
    again = grading.scores(every_starter, counted=False)  # a busy machine may have cost them points
    of_starters = {program: max(score, again[program]) for program, score in of_starters.items()}
    return findings()


def _starters(task: Exercise) -> list[EditionProgram]:
    """The starter of an exercise as a program, and as its notebook has it."""
    files = [task.folder / task.starter, task.folder / task.notebook]
    return [
        EditionProgram(task.id, source, f"exercises/{exercise_folders.place(task.folder)}/{file.name}", "the starter")
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


def _solution(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        return ""


class _Grading:
    """Grades programs side by side."""

    def __init__(self, executor: Executor, tasks: Mapping[str, Exercise], watcher: ProofWatcher) -> None:
        self.tasks = tasks
        self._executor = executor
        self._watcher = watcher

    def scores(
        self, programs: Sequence[EditionProgram], *, counted: bool = True, tries: int = _TRIES
    ) -> dict[tuple[str, str], float]:
        """The best score of each program; 0 for what no grader would take.

        Args:
            programs: which; one that is there twice is graded once.
            counted: tell the watcher of each.
            tries: how often a grading that fails by itself is begun.

        Raises:
            GradingError: a grading has failed by itself as often as that.
        """
        scores = {one.program: 0.0 for one in programs}
        waiting = {
            self._executor.submit(Task(self.tasks[one.exercise], text, one.file, seed)): one
            for one, text in self._submissions({one.program: one for one in programs}.values())
            for seed in _seeds(self.tasks[one.exercise])
        }
        left = Counter(one.program for one in waiting.values())
        failed: dict[EditionProgram, str] = {}
        for future in as_completed(waiting):
            one, report = waiting[future], future.result()
            if report.status == "error":
                failed[one] = report.problem
            scores[one.program] = max(scores[one.program], report.score)
            left[one.program] -= 1
            if counted and not left[one.program]:
                self._watcher.done()
        if failed and tries == 1:
            one, problem = next(iter(failed.items()))
            raise GradingError(
                f"Nothing is proven, because {one.file} ({one.place}) could not be graded as {one.exercise}: {problem} "
                "Run this again."
            )
        return scores | (self.scores(list(failed), counted=False, tries=tries - 1) if failed else {})

    def _submissions(self, programs: Iterable[EditionProgram]) -> list[tuple[EditionProgram, Submission]]:
        """The programs as the graders take them."""
        found = []
        with tempfile.TemporaryDirectory(prefix="course-kit-release-") as folder, Reader() as reader:
            file = Path(folder) / "program.py"
            for one in programs:
                file.write_text(one.source, encoding="utf-8", errors="replace")
                with suppress(UnreadableError):
                    found.append((one, _read(reader, file, self.tasks[one.exercise])))
        return found


def _seeds(task: Exercise) -> list[int]:
    """What the checks draw from: answers are marked with several draws, as a class may get one each."""
    if not task.variable:
        return [_SEED]
    own = [] if task.seed is None else [task.seed]
    return list(dict.fromkeys([*own, *range(_DRAWS)]))

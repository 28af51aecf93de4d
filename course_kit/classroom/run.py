"""Grades a class: each distinct submission once, every result written the moment it is there.

Whatever stops a run (Ctrl-C, a crash, a power cut, a full disk) costs at most what was under way; the next run with
`resume` takes the records that are there and goes on.
"""

from __future__ import annotations

import json
import secrets
from concurrent.futures import FIRST_COMPLETED, wait
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

from course_kit.classroom import intake, submissions, table
from course_kit.classroom.concurrency import early
from course_kit.classroom.gradebook import Gradebook
from course_kit.classroom.preconditions import WORKSPACE, require_folders_apart, require_submissions
from course_kit.classroom.records import Records
from course_kit.environment import write_atomically
from course_kit.grading import engine
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader, ReadingStoppedError
from course_kit.grading.render.html import render_page

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from concurrent.futures import Future
    from pathlib import Path

    from course_kit.classroom.executors import Executor
    from course_kit.classroom.records import Entry, Record
    from course_kit.classroom.roster import Roster
    from course_kit.classroom.submissions import Handed
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.report import Report

RUN_FILE = "run.json"
FORMAT_VERSION = 1
_AHEAD = 2  # tasks given to an executor for each of its slots: none idles, and few are lost
_LISTEN_S = 0.5  # how often a wait for results looks at the clock and at who wants to stop
_AT_ONCE = 2  # requests to stop


class Watcher(Protocol):
    """Told how a run goes."""

    def begin(self, total: int, ready: Sequence[Record]) -> None:
        """So many submissions, and the results that are there already."""

    def done(self, record: Record) -> None:
        """One more has its result."""

    def tick(self) -> None:
        """Some time has passed."""

    def stopping(self, under_way: int) -> None:
        """Ctrl-C: nothing new is begun, so many are finished."""


@dataclass(frozen=True)
class Plan:
    """What to grade.

    Attributes:
        source: a folder or a zip.
        more: further ones of the same class.
        roster: who is in the class.
        out: the folder for all results.
        exercises: what was set.
        seed: what all checks draw from; drawn once for the run when None.
        seeds: other seeds for some students, as for exercise 4.
        layout: a layout's name, or "auto".
        resume: go on where an earlier run into the same folder has ended.
    """

    source: Path
    out: Path
    exercises: tuple[Exercise, ...]
    seed: int | None = None
    seeds: Mapping[str, int] = field(default_factory=dict)
    layout: str = "auto"
    resume: bool = False
    more: tuple[Path, ...] = ()
    roster: Roster | None = None

    @property
    def sources(self) -> tuple[Path, ...]:
        """All folders and zips."""
        return (self.source, *self.more)


class ClassRun:
    """One run over a class."""

    def __init__(self, plan: Plan, watcher: Watcher, stops: Callable[[], int] = lambda: 0) -> None:
        """Look at the output folder and find the submissions.

        Args:
            plan: what to grade.
            watcher: told how it goes.
            stops: how often somebody has asked to stop: once, and what is under way is finished; twice, given up.

        Raises:
            GradingError: there is nothing to grade, one of the folders lies in the other, or the output folder holds
                results and `resume` was not asked, or results of an exercise that is not in the plan.
            OSError: the output folder cannot be written.
        """
        self._plan = plan
        self._watcher = watcher
        self._stops = stops
        self._records = Records(plan.out)
        require_folders_apart(plan.sources, plan.out)
        self.seed = self._choose_seed()
        try:
            self.intake = intake.collect(
                plan.sources, plan.exercises, plan.out / WORKSPACE, plan.layout, self._stopped, plan.roster
            )
        except ReadingStoppedError:
            raise KeyboardInterrupt from None  # nothing has begun
        table.write(self.intake, plan.out)
        require_submissions(self.intake, plan.sources, plan.exercises)
        run_file = json.dumps({"format_version": FORMAT_VERSION, "seed": self.seed})
        write_atomically(plan.out / RUN_FILE, f"{run_file}\n")
        self._done: list[Record] = []
        # One student's program must not read another's, nor the results.
        self._hidden = tuple(str(folder.resolve()) for folder in (*plan.sources, plan.out))

    def grade(self, start: Callable[[], Executor]) -> Gradebook:
        """Grade what has no result yet.

        Args:
            start: makes the executor; called only when there is something to do.

        Raises:
            OSError: a result could not be written, as on a full disk; those before it are safe.
        """
        # It gets ready while the submissions are read.
        executor = start() if any(self._records.find(entry) is None for entry in self.intake.entries) else None
        try:
            if groups := self._take_stock():
                executor = executor or start()
                self._work_through(groups, executor)
        finally:
            if executor is not None:
                executor.close()
        return self._gradebook()

    def _stopped(self) -> bool:
        return self._stops() > 0

    def _choose_seed(self) -> int:
        """The run's seed: that of the earlier run when it is gone on with."""
        asked = self._plan.seed
        before = _seed_of_run(self._plan.out / RUN_FILE)
        if not self._plan.resume and (before is not None or any(self._records)):
            raise GradingError(
                f"{self._plan.out} holds the results of an earlier run. Add --resume to continue it, or name "
                "another folder."
            )
        self._require_all_exercises()
        if before is not None and asked not in (None, before):
            raise GradingError(f"The earlier run used the seed {before}. Leave --seed out to continue it.")
        return next(one for one in (before, asked, secrets.randbits(31)) if one is not None)

    def _require_all_exercises(self) -> None:
        """See that no result of an earlier run would be missing from the grades."""
        named = {exercise.id for exercise in self._plan.exercises}
        if left_out := sorted({record.entry.exercise for record in self._records} - named):
            raise GradingError(
                f"{self._plan.out} also holds results of {', '.join(left_out)}; they would be missing from the grades. "
                f"Add {' '.join(f'--exercise {one}' for one in left_out)}, or name another folder."
            )

    def _take_stock(self) -> list[list[Handed]]:
        """Read all submissions; returns those without a result, identical ones together.

        What may last comes first: its patience passes beside the work on the others, not after it.
        """
        groups: dict[tuple[str, str, int], list[Handed]] = {}
        try:
            with Reader(self._stopped) as reader:
                for entry in self.intake.entries:
                    known = self._records.find(entry)
                    one = self._read(entry, reader, known)
                    if known is not None and one.has_result(known):
                        self._done.append(known)
                    else:
                        groups.setdefault(one.key, []).append(one)
        except ReadingStoppedError:
            groups = {}
        self._watcher.begin(len(self.intake.entries), self._done)
        return early(groups.values(), lambda group: group[0].may_last)

    def _read(self, entry: Entry, reader: Reader, known: Record | None) -> Handed:
        exercise = next(one for one in self._plan.exercises if one.id == entry.exercise)
        usual = self.seed if exercise.seed is None else exercise.seed
        seed = self._plan.seeds.get(entry.student, usual)
        return submissions.read(entry, self.intake.root, exercise, seed, reader, known=known)

    def _work_through(self, groups: list[list[Handed]], executor: Executor) -> None:
        waiting = iter(groups)
        under_way: dict[Future[Report], list[Handed]] = {}
        stopping = False
        while self._stops() < _AT_ONCE:
            if self._stops() and not stopping:
                stopping = True
                for future in [future for future in under_way if future.cancel()]:
                    del under_way[future]
                self._watcher.stopping(len(under_way))
            if not stopping:
                self._fill(executor, waiting, under_way)
            if not under_way:
                return
            finished, _ = wait(under_way, _LISTEN_S, FIRST_COMPLETED)
            for future in [one for one in under_way if one in finished]:  # in the order they were given out
                group = under_way.pop(future)
                self._keep(group, _result(group[0], future))
            self._watcher.tick()

    def _fill(
        self,
        executor: Executor,
        waiting: Iterator[list[Handed]],
        under_way: dict[Future[Report], list[Handed]],
    ) -> None:
        """Give the executor enough to do."""
        while len(under_way) < _AHEAD * executor.slots:
            group = next(waiting, None)
            if group is None:
                return
            task = group[0].task(self._hidden)
            if task is None:
                self._keep(group, group[0].unreadable())
            else:
                under_way[executor.submit(task)] = group

    def _keep(self, group: list[Handed], report: Report) -> None:
        """Write the result of a submission and of those identical to it."""
        first, *twins = group
        record = first.record(report)
        for one in (record, *(twin.same_record(record) for twin in twins)):
            self._records.keep(one, render_page(report, one.entry.name or one.entry.student))
            self._done.append(one)
            self._watcher.done(one)

    def _gradebook(self) -> Gradebook:
        return Gradebook(
            exercises=self._plan.exercises,
            records=tuple(sorted(self._done, key=lambda one: (one.entry.student, one.entry.exercise))),
            missing=self.intake.missing,
            left=self.intake.left,
            layout=self.intake.layout,
            seed=self.seed,
            complete=len(self._done) == len(self.intake.entries),
            root=self.intake.root,
            odd=self.intake.odd,
            dropped=self.intake.dropped,
            names=dict(self.intake.roster.absent) if self.intake.roster else {},
        )


def _result(submission: Handed, future: Future[Report]) -> Report:
    """The report; where grading itself has failed one that says so, as nothing may end the grading of the others."""
    try:
        return future.result()
    except Exception as problem:  # noqa: BLE001 - of a cluster, of a worker; whatever it is, it is not the student's
        why = f"The grading failed: {problem or type(problem).__name__}"
        return engine.unreadable(submission.exercise, submission.entry.source, why, status="error")


def _seed_of_run(path: Path) -> int | None:
    """The seed an earlier run has noted; None if there was none."""
    try:
        return int(json.loads(path.read_text(encoding="utf-8"))["seed"])
    except (OSError, ValueError, KeyError, TypeError):
        return None

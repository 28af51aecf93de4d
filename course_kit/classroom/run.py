"""Grades a class: each distinct submission once, every result written the moment it is there.

Whatever stops a run costs at most what was under way. With `resume` the next run keeps the results of what is the same,
grades what is new or has changed, and moves the results of what is gone to `superseded`.
"""

from __future__ import annotations

import secrets
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom import run_folder, submissions
from course_kit.classroom.grading_loop import ClassGrading
from course_kit.classroom.intake import collecting
from course_kit.classroom.records import Gradebook, RecordFolder
from course_kit.classroom.rules import instructor
from course_kit.classroom.rules.people import People
from course_kit.classroom.rules.seeds import match_class
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader, ReadingStoppedError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from course_kit.classroom.grading_loop import RunProgress
    from course_kit.classroom.intake.collecting import Intake
    from course_kit.classroom.intake.roster import Roster
    from course_kit.classroom.records import Entry, GradeRecord
    from course_kit.classroom.rules.instructor import Instructions
    from course_kit.classroom.rules.seeds import Seeds
    from course_kit.classroom.submissions import ClassSubmission
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.pool import Graders

WORKSPACE = "handed_in"  # where an archive is unpacked, in the output folder
_NAMED = 3  # things that are there where there is no submission


@dataclass(frozen=True)
class Plan:
    """What to grade."""

    sources: tuple[Path, ...]  # folders and zips of one class
    out: Path  # the folder for all results
    exercises: tuple[Exercise, ...]  # what was set
    seed: int | None = None  # what all checks draw from; drawn once for the run when None
    seeds: Seeds | None = None  # a seed for each student, where each gets different questions
    layout: str = "auto"  # a layout's name, or "auto"
    resume: bool = False  # go on where an earlier run into the same folder has ended
    roster: Roster | None = None  # who is in the class
    require_isolation: bool = False  # no submission runs where it is not fully isolated


def open_class(plan: Plan, stops: Callable[[], int] = lambda: 0) -> ClassRun:
    """Read what an earlier run has left, the instructor's files and what was handed in; grades nothing yet."""
    require_folders_apart(plan.sources, plan.out)
    records = RecordFolder(plan.out)
    seed = _choose_seed(plan, records)
    reader = Reader(lambda: stops() > 0)
    graded_now = {exercise.id for exercise in plan.exercises}
    earlier = tuple(record for record in records if record.entry.exercise not in graded_now)
    graded_earlier = sorted({record.entry.exercise for record in earlier})
    exercises = (*plan.exercises, *(run_folder.exercise_of(plan.out, name) for name in graded_earlier))
    instructions = instructor.read_instructions(plan.out, exercises)
    intake = _collect(plan, plan.out / WORKSPACE, reader)
    require_submissions(intake, plan.sources, plan.exercises)
    # What the instructor has written is about this class: that is seen before hours go into grading it.
    people = People((*intake.entries, *intake.others, *(record.entry for record in earlier)))
    instructions = instructions.match_people(people)
    seeds = match_class(plan.seeds, intake.entries, people) if plan.seeds else None
    run_folder.write_note(plan.out, seed, plan.exercises)
    return ClassRun(replace(plan, seed=seed, seeds=seeds), exercises, intake, instructions, earlier, reader)


def _choose_seed(plan: Plan, records: RecordFolder) -> int:
    """The run's seed: that of the earlier run when it is gone on with."""
    before = run_folder.read_note(plan.out).seed
    if not plan.resume and (before is not None or any(records)):
        raise GradingError(
            f"{plan.out} holds the results of an earlier run. Add --resume to continue it, or name another folder."
        )
    if before is not None and plan.seed not in (None, before):
        raise GradingError(f"The earlier run used the seed {before}. Leave --seed out to continue it.")
    return next(seed for seed in (before, plan.seed, secrets.randbits(31)) if seed is not None)


@dataclass
class ClassRun:
    """One run over a class, with what `open_class` has read."""

    plan: Plan
    exercises: tuple[Exercise, ...]  # those that are graded, and those of which there are results already
    intake: Intake
    instructions: Instructions
    earlier: tuple[GradeRecord, ...]  # the results of exercises that are not graded now
    reader: Reader
    gone: list[str] = field(default_factory=list)  # results whose submission is gone

    @property
    def hidden_folders(self) -> tuple[str, ...]:
        """No submission may see these: one student's program must not read another's, nor the results."""
        return tuple(str(folder.resolve()) for folder in (*self.plan.sources, self.plan.out))

    @property
    def _records(self) -> RecordFolder:
        return RecordFolder(self.plan.out)

    def grade(self, start: Callable[[], Graders], progress: RunProgress, stops: Callable[[], int]) -> Gradebook:
        """Grade what has no result yet, or has changed."""
        self._take_away_what_is_gone()
        # It gets ready while the submissions are read.
        graders = start() if any(self._records.find(entry) is None for entry in self.intake.entries) else None
        isolated = self.plan.require_isolation
        grading = ClassGrading(self._records, progress, stops, self.hidden_folders, require_isolation=isolated)
        try:
            earlier, groups = self._take_stock()
            progress.begin(len(self.intake.entries), earlier)
            if groups:
                graders = graders or start()
                grading.run(groups, graders)
        finally:
            if graders is not None:
                graders.close()
        return self._gradebook([*earlier, *grading.done])

    def as_it_is(self) -> Gradebook:
        """The results there are, of what is handed in; nothing is graded."""
        found = (self._records.find(entry) for entry in self.intake.entries)
        return self._gradebook([record for record in found if record is not None])

    @property
    def seed(self) -> int:
        """What the checks draw from if neither the student nor the exercise has a seed."""
        return self.plan.seed or 0

    def _take_away_what_is_gone(self) -> None:
        """Drop results of submissions that are gone from the inbox, and what a crash has left."""
        self._records.remove_pages_alone()
        exercises = [exercise.id for exercise in self.plan.exercises]
        for path in self._records.list_stray_records(self.intake.entries, exercises):
            record = self._records.supersede(path)
            whose = record.entry.label if record else path.parent.name
            self.gone.append(f"{whose}, {path.stem}")

    def _take_stock(self) -> tuple[list[GradeRecord], list[list[ClassSubmission]]]:
        """Read all submissions; returns the results there are, and the others, identical ones together."""
        found = ((entry, self._records.find(entry)) for entry in self.intake.entries)
        with self.reader:
            ready, groups = submissions.sort_out((self._read(entry, known), known) for entry, known in found)
        here = {entry.student for entry in self.intake.entries}
        earlier = []
        for submission, known in ready:
            record = submission.kept_record(known)
            earlier.append(record if record.same_as in here else replace(record, same_as=""))
            if earlier[-1] != known:
                self._records.keep(earlier[-1])
        return earlier, groups

    def _read(self, entry: Entry, known: GradeRecord | None) -> ClassSubmission:
        exercise = next(exercise for exercise in self.plan.exercises if exercise.id == entry.exercise)
        own = self.plan.seeds.find(entry.student) if self.plan.seeds else None
        seed = next(number for number in (own, exercise.seed, self.seed) if number is not None)
        return submissions.read_submission(entry, self.intake.root, exercise, seed, self.reader, known=known)

    def _gradebook(self, done: list[GradeRecord]) -> Gradebook:
        fit, earlier = self.intake.roster, self.earlier
        records = sorted([*done, *earlier], key=lambda record: (record.entry.student, record.entry.exercise))
        there = {(record.entry.student, record.entry.exercise) for record in records}
        missing = dict.fromkeys(self.intake.missing)
        if earlier:  # somebody who handed in one week's exercise and not the other's
            students = dict.fromkeys([*(record.entry.student for record in records), *(name for name, _ in missing)])
            missing |= dict.fromkeys((student, exercise.id) for student in students for exercise in self.exercises)
        book = Gradebook(
            exercises=tuple(sorted(self.exercises, key=lambda exercise: exercise.order)),
            records=tuple(records),
            missing=tuple(pair for pair in missing if pair not in there),
            earlier=frozenset(record.entry.exercise for record in earlier),
            left=self.intake.left,
            layout=self.intake.layout,
            seed=self.seed,
            complete=len(done) == len(self.intake.entries),
            root=self.intake.root,
            reader=self.reader,
            odd=self.intake.odd,
            dropped=self.intake.dropped,
            others=self.intake.others,
            absent=tuple((person.student, person.name) for person in fit.absent) if fit else (),
            unknown=fit.unknown if fit else (),
            canvas_assignments=fit.roster.canvas_assignments if fit else (),
        )
        return self.instructions.apply(book)


def look_only(plan: Plan, stopped: Callable[[], bool] = lambda: False) -> Intake:
    """Find the submissions and write their table into the output folder; nothing else is written there."""
    require_folders_apart(plan.sources, plan.out)
    with tempfile.TemporaryDirectory(prefix="course-kit-intake-") as folder:
        return _collect(plan, Path(folder) / WORKSPACE, Reader(stopped))


def _collect(plan: Plan, workspace: Path, reader: Reader) -> Intake:
    try:
        found = collecting.collect_submissions(
            plan.sources, plan.exercises, workspace, plan.layout, reader, plan.roster
        )
    except ReadingStoppedError:
        raise KeyboardInterrupt from None  # nothing has begun
    collecting.write_intake(found, plan.out)
    return found


def stored_gradebook(out: Path) -> Gradebook:
    """The results in a folder, without what was handed in."""
    records = tuple(sorted(RecordFolder(out), key=lambda record: (record.entry.student, record.entry.exercise)))
    if not records:
        raise GradingError(f"{out} holds no results of a class. Name the folder that --out named.")
    exercises = (run_folder.exercise_of(out, name) for name in {record.entry.exercise for record in records})
    return Gradebook(tuple(sorted(exercises, key=lambda exercise: exercise.order)), records)


def require_submissions(found: Intake, sources: Sequence[Path], exercises: Sequence[Exercise]) -> None:
    """See that there is anything to grade."""
    if found.entries:
        return
    seen = [*found.dropped, *found.left][:_NAMED]
    wanted = ", ".join(exercise.id for exercise in exercises)
    raise GradingError(
        f"{', '.join(map(str, sources))} holds no submission for {wanted}, read with the layout "
        f"'{found.layout}'. It holds: "
        f"{'; '.join(f'{one_line(what)} ({one_line(why)})' for what, why in seen) or 'nothing'}. "
        "Name the right exercise with --exercise, or the layout with --layout."
    )


def require_folders_apart(sources: Sequence[Path], out: Path) -> None:
    """See that results are not taken for submissions, and that nothing handed in is written over."""
    for given in sources:
        try:
            source, results = given.resolve(), out.resolve()
        except (OSError, RuntimeError):  # a loop of links, which is said when one of them is opened
            continue
        if source == results or source in results.parents:
            raise GradingError(f"The results would lie in {given}, the submissions. Name another folder with --out.")
        if results in source.parents and (given.is_dir() or results / WORKSPACE in source.parents):
            raise GradingError(f"{given} lies in {out}, the folder for the results. Name another folder with --out.")

"""`course-kit class`: grades a whole class and writes everything that an instructor and a learning platform need."""

from __future__ import annotations

import shlex
import signal
import sys
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.text.console import note

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from course_kit.classroom.grading_loop import RunProgress
    from course_kit.classroom.intake.collecting import Intake
    from course_kit.classroom.intake.roster import Roster
    from course_kit.classroom.intake.roster_matching import RosterFit
    from course_kit.classroom.records import Entry, Gradebook
    from course_kit.classroom.regrade import GradeChange
    from course_kit.classroom.rules.seeds import Seeds
    from course_kit.classroom.run import ClassRun, Plan
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.pool import Graders

FAILED, INTERRUPTED = 2, 130
_MOST_NAMED = 20  # students in a sentence; the class page has them all


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "class",
        help="grade a whole class: a folder or zip of submissions",
        epilog=(
            "After Ctrl-C, a crash or a full disk, run the same command with --resume. Exit code: 0 if every "
            "submission has its grade; 2 if the run failed, found no submissions, skipped a student, or could not "
            "grade a submission for a reason outside the student's control; 130 if it was stopped."
        ),
    )
    parser.add_argument(
        "submissions",
        type=Path,
        nargs="+",
        help="a folder or zip from your learning platform; you may give several, or a folder of zips",
    )
    parser.add_argument(
        "--exercise",
        action="append",
        required=True,
        metavar="ID",
        help="an exercise to grade; may be repeated",
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="the folder for all results")
    parser.add_argument("--resume", action="store_true", help="continue an earlier run into DIR")
    parser.add_argument(
        "--again",
        action="append",
        default=[],
        metavar="ID",
        help="with --resume: grade an exercise again, show whose result changes and how, and ask before saving",
    )
    parser.add_argument("--write", action="store_true", help="with --again: save the changes without asking")
    parser.add_argument(
        "--dry-run", action="store_true", help="show which file of each student would be graded and why; grade nothing"
    )
    parser.add_argument(
        "--roster",
        type=Path,
        metavar="CSV",
        help="the class list: an export of Canvas, Moodle or nbgrader, or another CSV file",
    )
    parser.add_argument(
        "--layout", default="auto", help="canvas, moodle, gradescope, nbgrader, github, folders or files"
    )
    parser.add_argument("--seed", type=int, help="draw the same random values as an earlier run")
    parser.add_argument(
        "--seeds",
        type=Path,
        metavar="CSV",
        help="a table of student and seed, for an exercise that draws questions: each student gets different ones",
    )
    parser.add_argument("--require-isolation", action="store_true", help="refuse to grade without full isolation")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, metavar="N", help="number of gradings at the same time on this machine")
    where.add_argument("--scheduler", metavar="ADDRESS", help="a Dask scheduler, such as tcp://10.0.0.1:8786")
    parser.set_defaults(run=grade_class)


def grade_class(options: argparse.Namespace) -> int:
    """Grade the class, and say in a sentence what stopped it."""
    from course_kit.classroom.cluster import SchedulerLostError

    try:
        return _run(options)
    except KeyboardInterrupt:  # before the first grading; what had begun ends by itself, and says how to go on
        print_safely("\ncourse-kit: stopped. Nothing was graded; run the same command again.")
        return INTERRUPTED
    except SchedulerLostError as problem:
        print_safely(
            f"\ncourse-kit: {problem} The results so far are safe. Start a scheduler and its workers, then run:\n"
            f"  {command_to_continue(options)}"
        )
    except OSError as problem:
        where = f" ({problem.filename})" if problem.filename else ""
        print_safely(
            f"\ncourse-kit: a result could not be written: {problem.strerror or problem}{where}. The results before it "
            f"are safe. Fix this, then run:\n  {command_to_continue(options)}"
        )
    return FAILED


def _run(options: argparse.Namespace) -> int:
    from course_kit.grading import GradingError, advice_for_root, isolation_status
    from course_kit.grading.model.exercise import load_exercise
    from course_kit.grading.sandbox import needs

    chosen = {name: load_exercise(name) for name in options.exercise}
    if options.out.exists() and not options.out.is_dir():
        raise GradingError(f"{options.out} is a file. Give --out a folder for the results.")
    if options.again and not options.resume:
        raise GradingError("--again works on the results of an earlier run. Add --resume.")
    if unknown := [name for name in options.again if name not in chosen]:
        raise GradingError(f"--again has {', '.join(unknown)}, and --exercise does not. Give it to both.")
    if options.write and not options.again:
        raise GradingError("--write saves the changes of --again. Name the exercise with --again, too.")
    if options.dry_run:
        return _dry_run(_plan(options, chosen.values()))
    if not options.scheduler:
        note(advice_for_root())
        for exercise in chosen.values():
            needs.require_machine(exercise.limits)
        if options.require_isolation:  # each worker insists on it, too; of a cluster only they can
            isolation_status().require()
    with ExitStack() as ends:
        early = None  # the workers of this machine get ready while all else is loaded; a resumed run may need none
        if not (options.scheduler or options.resume):
            early = start_graders(options, list(chosen.values()))
            ends.callback(early.close)
        return _grade(options, _plan(options, chosen.values()), early)


def _plan(options: argparse.Namespace, exercises: Iterable[Exercise]) -> Plan:
    from course_kit.classroom.intake import roster
    from course_kit.classroom.rules import seeds
    from course_kit.classroom.run import Plan

    return Plan(
        sources=tuple(options.submissions),
        roster=roster.read_roster(options.roster) if options.roster else None,
        out=options.out,
        exercises=tuple(sorted(exercises, key=lambda exercise: exercise.order)),
        seed=options.seed,
        seeds=seeds.read_seeds(options.seeds) if options.seeds else None,
        layout=options.layout,
        resume=options.resume,
        require_isolation=options.require_isolation,
    )


def _grade(options: argparse.Namespace, plan: Plan, early: Graders | None) -> int:
    from course_kit.classroom import run_folder
    from course_kit.classroom.grading_loop import RunProgress
    from course_kit.classroom.records import SUPERSEDED
    from course_kit.classroom.run import open_class, require_folders_apart

    require_folders_apart(plan.sources, plan.out)
    tally = RunProgress(sys.stderr)
    with run_folder.hold_folder(plan.out):
        with count_interrupts() as stops:
            grading = open_class(plan, stops)
            start = partial(start_graders, options, plan.exercises)
            book = grading.grade(lambda: early or start(), tally, stops)
            if options.again and book.complete:
                book = grade_again(options, grading, tally, start, stops) or book
        tally.end()
        say_of_intake(grading.intake, plan.exercises)
        if grading.gone:
            print_safely(
                f"{count_of(grading.gone, 'result')} moved to {plan.out / SUPERSEDED}: the submission is no longer "
                f"there: {first_of(grading.gone, '; ')}."
            )
        for exercise in plan.exercises:
            if practised := _students_with_practice_seed(book, exercise, plan.seeds):
                note(
                    f"{exercise.id}: {count_of(practised, 'submission')} graded with the practice questions "
                    f"(seed {exercise.seed}), whose answers every student has. "
                    "For a grade that counts, give each student a seed: --seeds."
                )
        return _finish(book, options)


def _students_with_practice_seed(book: Gradebook, exercise: Exercise, seeds: Seeds | None) -> list[str]:
    """Whose submissions of an exercise were graded with what everybody practises with."""
    graded = [record.entry for record in book.records if record.entry.exercise == exercise.id]
    if exercise.seed is None:
        return []
    return [entry.student for entry in graded if (seeds and seeds.find(entry.student)) in (None, exercise.seed)]


def _dry_run(plan: Plan) -> int:
    """Print the table of what would be graded."""
    from course_kit.classroom.intake import collecting
    from course_kit.classroom.run import look_only, require_submissions
    from course_kit.text.sanitize import make_printable

    with count_interrupts() as stops:
        found = look_only(plan, lambda: stops() > 0)
    print(make_printable(collecting.format_intake(found)))
    say_of_intake(found, plan.exercises)
    print(plan.out / collecting.FILE)
    require_submissions(found, plan.sources, plan.exercises)
    if found.dropped:
        note(_left_out(found.dropped, (*found.entries, *found.others)))
    return FAILED if found.dropped else 0


def _finish(book: Gradebook, options: argparse.Namespace) -> int:
    from course_kit.classroom import exports

    out = options.out
    page = exports.write_all(book, out)
    if book.left:
        print_safely(f"Not graded: {count_of(book.left, 'other file')} in the folder. {page.name} says why.")
    if book.odd:
        odd = first_of(_each_named(book.odd, book.entries))
        print_safely(f"Graded as separate students, because their names do not fit the layout '{book.layout}': {odd}.")
    print(page)
    for notice in _notices(book):
        print_safely(notice)
    worries = list(_describe_missing_grades(book))
    for worry in worries:
        note(worry)
    if not book.complete:
        note(f"stopped. To continue, run:\n  {command_to_continue(options)}")
        return INTERRUPTED
    return FAILED if worries else 0


def _notices(book: Gradebook) -> Iterator[str]:
    """What the instructor may want to look at, a sentence each."""
    from course_kit.classroom import regrade
    from course_kit.classroom.rules import instructor

    yield from instructor.moment_warnings(book)
    if others := regrade.graded_otherwise(book):
        counts = ", ".join(f"{count} of {exercise}" for exercise, count in others.items())
        yield (
            f"Graded by another version of the kit or the exercise than today's: {counts}. "
            "To see what it would change, run the same command with --resume and --again EXERCISE."
        )


def _describe_missing_grades(book: Gradebook) -> Iterator[str]:
    """What is missing from the grades, a sentence each."""
    if book.dropped:
        yield _left_out(book.dropped, book.entries)
    if failed := book.not_graded:
        whose = [f"{record.entry.label}, {record.entry.exercise}" for record in failed]
        yield (
            f"{count_of(whose, 'submission')} could not be graded, for a reason outside the student's control: "
            f"{first_of(whose, '; ')}. Run the same command with --resume."
        )


def _each_named(reasons: Sequence[tuple[str, str]], entries: Iterable[Entry]) -> list[str]:
    """Students with their names, each with a reason."""
    called = {entry.student: entry.label for entry in entries}
    return [f"{called.get(student, student)} ({reason})" for student, reason in reasons]


def _left_out(dropped: Sequence[tuple[str, str]], entries: Iterable[Entry]) -> str:
    reasons = _each_named(dropped, entries)
    return f"{count_of(reasons, 'student')} handed in something that was not graded: {first_of(reasons)}."


def start_graders(options: argparse.Namespace, exercises: Sequence[Exercise]) -> Graders:
    """Where submissions are graded, as the options say."""
    if options.scheduler:
        from course_kit.classroom.cluster import Cluster

        return Cluster(options.scheduler)
    from course_kit.grading.pool import start_pool

    started = start_pool(exercises, options.workers)
    import course_kit.classroom.exports  # noqa: F401 - needed at the end: now, while workers start, it costs no time

    return started


def command_to_continue(options: argparse.Namespace) -> str:
    """The command that goes on where this one has ended, as one would type it."""
    more = [] if options.resume else ["--resume"]
    return shlex.join([environment.course_command(), *options.arguments, *more])


def print_safely(text: str) -> None:
    """Tell a person something in which names of strangers may stand."""
    from course_kit.text.sanitize import make_printable

    print(make_printable(text), file=sys.stderr)


def count_of(of_what: Sequence[object], name: str) -> str:
    """`1 student`, `2 students`."""
    return f"{len(of_what)} {name}{'s' * (len(of_what) != 1)}"


def first_of(parts: Sequence[str], between: str = ", ") -> str:
    """The first ones, and how many more there are."""
    more = len(parts) - _MOST_NAMED
    return between.join(parts[:_MOST_NAMED]) + (f"{between}and {more} more" if more > 0 else "")


@contextmanager
def count_interrupts() -> Iterator[Callable[[], int]]:
    """Count Ctrl-C instead of being cut off by it in the middle of a result."""
    pressed: list[int] = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: pressed.append(number))
    try:
        yield lambda: len(pressed)
    finally:
        signal.signal(signal.SIGINT, before)


def say_of_intake(found: Intake, exercises: Iterable[Exercise]) -> None:
    """Tell what somebody should look at."""
    for sentence in _sentences(found, exercises):
        print_safely(sentence)


def _sentences(found: Intake, exercises: Iterable[Exercise]) -> Iterator[str]:
    called = {entry.student: entry.label for entry in (*found.entries, *found.others)}
    doubtful = [f"{entry.label}, {entry.exercise} ({entry.worry})" for entry in found.entries if entry.worry]
    if doubtful:
        yield f"Check these choices of file (see intake.csv): {first_of(doubtful)}."
    if found.roster is not None:
        yield from _of_roster(found.roster, called)
        yield from _of_canvas(found.roster.roster, exercises)


def _of_roster(fit: RosterFit, called: Mapping[str, str]) -> Iterator[str]:
    read_as = ", ".join(f"'{header}' is the {kind}" for header, kind in fit.roster.read_as)
    total = len(fit.roster.people)
    yield f"{fit.roster.called}: {read_as}. {fit.matched} of its {total} students handed something in."
    if fit.absent:
        yield f"Not handed in: {first_of([person.name or person.student for person in fit.absent])}."
    if fit.unknown:
        unknown = [f"{called.get(who, who)} ({why})" for who, why in fit.unknown]
        yield f"Not matched with {fit.roster.called}: {first_of(unknown)}."


def _of_canvas(roster: Roster, exercises: Iterable[Exercise]) -> Iterator[str]:
    """Which exercises of Canvas's gradebook have no assignment: its import would make a new one without asking."""
    from course_kit.classroom.exports.tables import CANVAS, canvas_assignment

    named = roster.canvas_assignments
    absent = [exercise.id for exercise in exercises if named and not canvas_assignment(exercise, named)]
    if absent:
        yield (
            f"{roster.called} has no assignment for {', '.join(absent)}, or more than one, so {CANVAS} adds a new "
            "column. To fill an existing one, put the exercise's name into the assignment's title in Canvas and export "
            "the gradebook again."
        )


def grade_again(
    options: argparse.Namespace,
    class_run: ClassRun,
    progress: RunProgress,
    start: Callable[[], Graders],
    stops: Callable[[], int],
) -> Gradebook | None:
    """Grade again what `--again` names; returns the new gradebook, None where nothing was written."""
    from course_kit.classroom.regrade import Regrade

    regrade = Regrade(class_run, class_run.as_it_is(), options.again, progress)
    changes = regrade.grade(start, stops)
    if not regrade.complete:
        note("stopped. No result was changed. The same command goes on.")
        return None
    book = regrade.write() if _is_wanted(changes, options) else None
    if regrade.failed:
        whose = [f"{record.entry.label}, {record.entry.exercise}" for record in regrade.failed]
        note(
            f"the grader failed for {count_of(whose, 'submission')}: "
            f"{first_of(whose, '; ')}. Their results stay as they are. Run the same command again."
        )
    return book


def _is_wanted(changes: Sequence[GradeChange], options: argparse.Namespace) -> bool:
    """Show what would change, and ask."""
    from course_kit.classroom.regrade import TABLE, change_table
    from course_kit.text.sanitize import make_printable

    for line in change_table(changes) if changes else ["No result changes."]:
        print(make_printable(line))
    print(f"The same as a file: {options.out / TABLE}", flush=True)
    if options.write or not changes:
        return bool(options.write)
    if not sys.stdin.isatty():
        print_safely("Nothing was written. To write it, run the same command with --write; nothing is graded twice.")
        return False
    wanted = count_of([change.row[0] for change in changes], "result")
    print(f"Write {wanted}? [y/N] ", end="", file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() in ("y", "yes"):
        return True
    print_safely("Nothing was written.")
    return False

"""`course-kit dev check`: proves that the graders are right, by the submissions that lie beside them.

See `rules` for what has to hold. With `--repeat` the same submissions are graded again and again, each time with other
random values, and the verdicts have to be the same; `--load` keeps the processors busy meanwhile.
"""

from __future__ import annotations

import argparse
import secrets
import sys
import time
from concurrent.futures import as_completed
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring import check_table, corpus, gradings, rules
from course_kit.grading import GradingError, Report
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.authoring.rules import Fault

    Progress = Callable[[int, int, "ProofSubmission", Report], None]


@dataclass(frozen=True)
class Run:
    """Every submission graded once."""

    seed: int  # what the random values were drawn from, in exercises without a seed of their own
    reports: dict[ProofSubmission, Report]  # by submission


@dataclass(frozen=True)
class ProofOutcome:
    """What `check` has found."""

    sets: tuple[Corpus, ...]  # the exercises, with their submissions
    runs: tuple[Run, ...]  # one for each repeat
    faults: tuple[Fault, ...]  # all that does not hold; proven when there is none
    busy: int  # how many processors were kept busy by us
    duration_s: float  # seconds on the wall
    partial: bool = False  # not all exercises were looked at


def check(  # noqa: PLR0913 - the options of one verb
    root: Path,
    exercises: Sequence[str] = (),
    *,
    repeat: int = 1,
    busy: int = 0,
    workers: int = 0,
    seed: int | None = None,
    progress: Progress | None = None,
) -> ProofOutcome:
    """Grade all submissions of some exercises and judge the outcome."""
    began = time.monotonic()
    chosen = tuple(corpus.load(name, root) for name in exercises or corpus.all_exercises(root))
    first = secrets.randbits(30) if seed is None else seed
    runs = tuple(Run(first + number, {}) for number in range(repeat))
    folders = {one.task.id: one.task.folder.parent for one in chosen}
    with gradings.load(busy), gradings.Gradings(root / "exercises", workers, folders) as pool:
        _grade(pool, chosen, runs, progress)
    found = [fault for one in chosen for fault in rules.faults(one, _of_exercise(runs[0], one))]
    found += list(_unstable(runs))
    if not exercises:
        found += rules.codes_without_submission({one.name for each in chosen for one in each.submissions})
    return ProofOutcome(chosen, runs, tuple(found), busy, time.monotonic() - began, partial=bool(exercises))


def _grade(pool: gradings.Gradings, chosen: Sequence[Corpus], runs: Sequence[Run], progress: Progress | None) -> None:
    begun = {}
    for run in runs:
        for one in chosen:
            seed = run.seed if one.task.seed is None else None
            begun.update(
                {
                    pool.begin(each, seed if each.seed is None else each.seed): (run, each)
                    for each in _longest_first(one)
                }
            )
    for number, future in enumerate(as_completed(begun), start=1):
        run, submission = begun[future]
        try:
            report = future.result()
        except GradingError as problem:
            report = _not_graded(submission, str(problem))
        run.reports[submission] = report
        if progress is not None:
            progress(number, len(begun), submission, report)


def _not_graded(submission: ProofSubmission, problem: str) -> Report:
    return Report(
        exercise=submission.exercise,
        title="",
        submission=str(submission.path),
        status="error",
        passed=False,
        score=0.0,
        max_score=0.0,
        duration_s=0.0,
        problem=problem,
    )


def _longest_first(one: Corpus) -> list[ProofSubmission]:
    """Right programs go through all checks, and limits are reached slowly: what begins late is waited for alone."""
    slow = ("starter", "solution", "variant")
    return sorted(one.submissions, key=lambda each: each.kind not in slow and not each.name.startswith("limit."))


def _of_exercise(run: Run, one: Corpus) -> dict[ProofSubmission, Report]:
    return {submission: run.reports[submission] for submission in one.submissions}


def _unstable(runs: Sequence[Run]) -> Iterator[Fault]:
    for number, run in enumerate(runs[1:], start=2):
        for submission, report in run.reports.items():
            first = runs[0].reports[submission]
            if rules.verdict(report) != rules.verdict(first):
                text = (
                    f"a different verdict in run {number} (seed {run.seed}): {rules.outcome(report)}. "
                    f"In the first run (seed {runs[0].seed}): {rules.outcome(first)}."
                )
                yield rules.Fault(submission.exercise, "stable", f"{submission.kind} {submission.name}", text)


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when all is proven, 1 when something does not hold, 2 when it could not be tried."""
    options = _parser().parse_args(arguments)
    root = environment.checkout()
    if root is None or not (root / "tests").is_dir():
        return cannot("the submissions belong to the course's folder; run this in a clone of it.")
    processors = gradings.processors()
    try:
        found = check(
            root,
            options.exercises,
            repeat=options.repeat,
            busy=processors if options.load else 0,
            workers=options.workers,
            seed=options.seed,
            progress=check_table.progress(sys.stderr),
        )
    except GradingError as problem:
        return cannot(problem)
    print(check_table.as_json(found) if options.format == "json" else check_table.as_text(found))
    return 1 if found.faults else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="course-kit dev check",
        description="Grade every submission that is there to prove an exercise, and check that each gets the verdict "
        "it is there for: of an exercise of your own its starter, its solution and what lies in its folder proof/.",
    )
    parser.add_argument(
        "exercises", nargs="*", metavar="EXERCISE", help="only these; the course's own when none is named"
    )
    parser.add_argument(
        "--repeat", type=_positive, default=1, metavar="N", help="number of runs; the verdicts must be the same"
    )
    parser.add_argument("--load", action="store_true", help="keep every processor busy meanwhile")
    parser.add_argument("--workers", type=_positive, default=0, metavar="N", help="number of gradings at the same time")
    parser.add_argument("--seed", type=int, help="draw the same random values again")
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument(  # `course-kit` has taken it out before, wherever it stands
        "--exercises", dest="folders", metavar="DIR", help="also the exercises in DIR, or the one that DIR is"
    )
    return parser


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("it has to be a number from 1 up")
    return number

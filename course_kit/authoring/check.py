"""`course-kit dev check`: proves that the graders are right, by the submissions that lie beside them.

See `rules` for what has to hold. With `--repeat` the same submissions are graded again and again, each time with other
random values, and the verdicts have to be the same.
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
from course_kit.authoring import corpus, rules
from course_kit.authoring.gradings import Gradings
from course_kit.grading import GradingError, Report
from course_kit.text.console import cannot, in_points, wrapped

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.authoring.rules import Fault

_WIDTH = 100
_EACH = 25  # gradings from one line of progress to the next
_KINDS = {"starter": "starter", "solution": "solution", "variants": "variant", "broken": "broken", "slips": "slip"}


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
    duration_s: float  # seconds on the wall


def check(
    root: Path, exercises: Sequence[str] = (), *, repeat: int = 1, workers: int = 0, seed: int | None = None
) -> ProofOutcome:
    """Grade all submissions of some exercises, tell on stderr how far it is, and judge the outcome."""
    began = time.monotonic()
    chosen = tuple(corpus.load(name, root) for name in exercises or corpus.all_exercises(root))
    first = secrets.randbits(30) if seed is None else seed
    runs = tuple(Run(first + number, {}) for number in range(repeat))
    with Gradings([one.task for one in chosen], workers) as pool:
        _grade(pool, chosen, runs)
    found = [fault for one in chosen for fault in rules.faults(one, runs[0].reports)]
    found += list(_unstable(runs))
    if not exercises:
        found += rules.codes_without_submission({one.name for each in chosen for one in each.submissions})
    return ProofOutcome(chosen, runs, tuple(found), time.monotonic() - began)


def _grade(pool: Gradings, chosen: Sequence[Corpus], runs: Sequence[Run]) -> None:
    begun = {
        pool.begin(one, _seed_for(one, each, run)): (run, one)
        for run in runs
        for each in chosen
        for one in _longest_first(each)
    }
    for number, future in enumerate(as_completed(begun), start=1):
        run, submission = begun[future]
        run.reports[submission] = report = future.result()
        if number % _EACH == 0 or number == len(begun):
            what = f"{submission.exercise} {submission.kind} {submission.name}: {in_points(report.score)}"
            sys.stderr.write(f"[{number}/{len(begun)}] {what}, {report.duration_s:.1f} s\n")
            sys.stderr.flush()


def _seed_for(submission: ProofSubmission, sets: Corpus, run: Run) -> int:
    return next(seed for seed in (submission.seed, sets.task.seed, run.seed) if seed is not None)


def _longest_first(one: Corpus) -> list[ProofSubmission]:
    """Right programs go through all checks, and limits are reached slowly: what begins late is waited for alone."""
    slow = ("starter", "solution", "variant")
    return sorted(one.submissions, key=lambda each: each.kind not in slow and not each.name.startswith("limit."))


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


def describe(found: ProofOutcome) -> Iterator[str]:
    """The table, what does not hold, and a summary, in lines."""
    names = [*_KINDS, "checks", "sentences", *(["same again"] if len(found.runs) > 1 else [])]
    rows = [["exercise", *names], *([one.task.id, *(_cell(found, one, name) for name in names)] for one in found.sets)]
    width = max(len(row[0]) for row in rows)
    for name, *cells in rows:
        yield "  ".join([f"{name:<{width}}", *(f"{cell:<10}" for cell in cells)]).rstrip()
    if found.faults:
        yield from ("", "What does not hold:")
    for fault in found.faults:
        yield from wrapped(f"✗ {fault}", following="    ", width=_WIDTH)
    count = sum(len(run.reports) for run in found.runs)
    first = found.runs[0]
    times, seeds = "once", f"seed {first.seed}"
    if len(found.runs) > 1:
        times, seeds = f"{len(found.runs)} times", f"seeds from {first.seed}"
    proven = f"NOT PROVEN: {len(found.faults)} faults." if found.faults else "PROVEN."
    how = f"{len(first.reports)} submissions graded {times}, {count} gradings in {found.duration_s:.0f} s"
    yield from ("", f"{proven} {how} ({seeds}).")


def _cell(found: ProofOutcome, one: Corpus, name: str) -> str:
    rule = "stable" if name == "same again" else name
    wrong = [fault for fault in found.faults if (fault.exercise, fault.rule) == (one.task.id, rule)]
    if name in _KINDS:
        count = len(one.of(_KINDS[name]))
    elif name == "checks":
        count = len({check.id for each in one.of("solution") for check in found.runs[0].reports[each].checks})
    else:
        count = len(one.task.sentences) if name == "sentences" else len(found.runs)
    if not wrong:
        return f"✓ {count}" if count else "-"
    submissions = {fault.submission for fault in wrong}
    return f"✗ {len(submissions)} of {count}" if all(submissions) and count else "✗"


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when all is proven, 1 when something does not hold, 2 when it could not be tried."""
    options = _parser().parse_args(arguments)
    root = environment.checkout()
    if root is None or not (root / "tests").is_dir():
        return cannot("the submissions belong to the course's folder; run this in a clone of it.")
    try:
        found = check(root, options.exercises, repeat=options.repeat, workers=options.workers, seed=options.seed)
    except GradingError as problem:
        return cannot(problem)
    print("\n".join(describe(found)))
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
    parser.add_argument("--workers", type=_positive, default=0, metavar="N", help="number of gradings at the same time")
    parser.add_argument("--seed", type=int, help="draw the same random values again")
    parser.add_argument(  # `course-kit` has taken it out before, wherever it stands
        "--exercises", dest="folders", metavar="DIR", help="also the exercises in DIR, or the one that DIR is"
    )
    return parser


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("it has to be a number from 1 up")
    return number

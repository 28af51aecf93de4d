"""`course-kit dev check`: proves that the graders are right, by the submissions that lie beside them.

See `rules` for what has to hold.
"""

from __future__ import annotations

import argparse
import secrets
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring import corpus, rules
from course_kit.authoring.gradings import Gradings
from course_kit.text.console import in_points, refuse, wrap_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.authoring.rules import Fault
    from course_kit.grading import Report

_WIDTH = 100
_EACH = 25  # gradings from one line of progress to the next
_KINDS = {"starter": "starter", "solution": "solution", "variants": "variant", "broken": "broken", "slips": "slip"}


@dataclass(frozen=True)
class ProofOutcome:
    """What `check` has found."""

    sets: tuple[Corpus, ...]  # the exercises, with their submissions
    seed: int  # what the random values were drawn from, in exercises without their own seed
    reports: dict[ProofSubmission, Report]
    faults: tuple[Fault, ...]  # all that does not hold; proven when empty
    duration_s: float  # seconds on the wall


def check_proofs(
    root: Path, exercises: Sequence[str] = (), *, workers: int | None = None, seed: int | None = None
) -> ProofOutcome:
    """Grade all submissions of some exercises and judge the outcome."""
    began = time.monotonic()
    chosen = tuple(corpus.load_corpus(name, root) for name in exercises or corpus.all_exercises(root))
    drawn = secrets.randbits(30) if seed is None else seed
    with Gradings([cases.exercise for cases in chosen], workers) as pool:
        reports = grade_corpora(pool, chosen, drawn)
    found = [fault for cases in chosen for fault in rules.find_faults(cases, reports)]
    if not exercises:
        found += rules.codes_without_submission({proof.name for each in chosen for proof in each.submissions})
    return ProofOutcome(chosen, drawn, reports, tuple(found), time.monotonic() - began)


def grade_corpora(pool: Gradings, chosen: Sequence[Corpus], seed: int) -> dict[ProofSubmission, Report]:
    """Grade all submissions of these sets, and tell on stderr how far it is."""
    wanted = [(item, _seed_for(item, each, seed)) for each in chosen for item in _longest_first(each)]
    reports: dict[ProofSubmission, Report] = {}
    for submission, report in pool.grade_all((item, pool.request_for(item, drawn)) for item, drawn in wanted):
        reports[submission] = report
        if len(reports) % _EACH == 0 or len(reports) == len(wanted):
            what = f"{submission.exercise} {submission.kind} {submission.name}: {in_points(report.score)}"
            sys.stderr.write(f"[{len(reports)}/{len(wanted)}] {what}, {report.duration_s:.1f} s\n")
            sys.stderr.flush()
    return reports


def _seed_for(submission: ProofSubmission, sets: Corpus, drawn: int) -> int:
    return next(seed for seed in (submission.seed, sets.exercise.seed, drawn) if seed is not None)


def _longest_first(cases: Corpus) -> list[ProofSubmission]:
    """Right programs go through all checks, and limits are reached slowly: what begins late is waited for alone."""
    slow = ("starter", "solution", "variant")
    return sorted(cases.submissions, key=lambda each: each.kind not in slow and not each.name.startswith("limit."))


def describe_outcome(found: ProofOutcome) -> Iterator[str]:
    """How many submissions there are, what does not hold, and a summary, in lines."""
    width = max(len(cases.exercise.id) for cases in found.sets)
    heads = [*_KINDS, "checks", "sentences"]
    yield "  ".join([f"{'exercise':<{width}}", *heads])
    for cases in found.sets:
        checks = {check.id for each in cases.of_kind("solution") for check in found.reports[each].checks}
        counts = [*(len(cases.of_kind(kind)) for kind in _KINDS.values()), len(checks), len(cases.exercise.sentences)]
        cells = (f"{count or '-':>{len(head)}}" for count, head in zip(counts, heads, strict=True))
        yield "  ".join([f"{cases.exercise.id:<{width}}", *cells])
    if found.faults:
        yield from ("", "What does not hold:")
    for fault in found.faults:
        yield from wrap_text(f"✗ {fault}", following="    ", width=_WIDTH)
    proven = f"NOT PROVEN: {len(found.faults)} faults." if found.faults else "PROVEN."
    yield ""
    yield f"{proven} {len(found.reports)} submissions graded in {found.duration_s:.0f} s (seed {found.seed})."


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when all is proven, 1 when something does not hold, 2 when it could not be tried."""
    options = _parser().parse_args(arguments)
    root = environment.checkout_folder()
    if root is None or not (root / "tests").is_dir():
        return refuse("the submissions belong to the course's folder; run this in a clone of it.")
    found = check_proofs(root, options.exercises, workers=options.workers, seed=options.seed)
    print("\n".join(describe_outcome(found)))
    return 1 if found.faults else 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=f"{environment.course_command()} dev check",
        description="Grade every program that proves an exercise, and check that each gets its verdict. For your own "
        "exercise these are its starter, its solution and what is in its folder proof/.",
    )
    parser.add_argument("exercises", nargs="*", metavar="EXERCISE", help="only these; if left out, those of the course")
    parser.add_argument("--workers", type=int, metavar="N", help="number of gradings at the same time")
    parser.add_argument("--seed", type=int, help="a number: the same number draws the same random values")
    parser.add_argument(  # `course-kit` has taken it out before, wherever it stands
        "--exercises", dest="folders", metavar="DIR", help="also the exercises in DIR, or the exercise DIR"
    )
    return parser

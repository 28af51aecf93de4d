"""The submissions that prove the graders are graded once in a test run, as `course-kit dev check` does it.

The usual run takes a sample of them, `./course test --all` grades each, with two seeds.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.authoring import check, corpus, rules
from course_kit.authoring.gradings import Gradings
from course_kit.grading.diagnosis.catalogue import catalogue
from course_kit.grading.model import exercise_folders

if TYPE_CHECKING:
    from course_kit.grading import Report

ROOT = environment.checkout() or Path()
EXERCISES = corpus.all_exercises(ROOT)
DRILLS = sorted(exercise_folders.drills(ROOT / "exercises"))


SAMPLE = "sample"
ONE_IN = 4  # of the others


@dataclass
class Proofs:
    """Reports of submissions, and what does not hold of them."""

    sets: list[corpus.Corpus]  # with all submissions, graded or not
    reports: dict[corpus.ProofSubmission, Report]
    faults: list[rules.Fault]

    def of(self, exercise: str, name: str, *kinds: str) -> Report:
        """The report of the submission of that name, wrong or of one of these kinds."""
        found = (one for one in self.reports if (one.exercise, one.name) == (exercise, name))
        return next(self.reports[one] for one in found if one.kind in (kinds or ("broken", "slip")))


def sample(one: corpus.Corpus) -> corpus.Corpus:
    """Starters, the solution, what is named after a diagnosis, and some of the others of each kind."""
    chosen = {each for each in one.submissions if each.kind in ("starter", "solution") or each.name in catalogue()}
    for kind in ("variant", "slip"):
        others = sorted(set(one.of(kind)) - chosen, key=lambda each: zlib.crc32(each.name.encode()))
        chosen.update(others[::ONE_IN])
    return corpus.Corpus(one.task, tuple(each for each in one.submissions if each in chosen))


@pytest.fixture(
    scope="session",
    params=[pytest.param(SAMPLE, id=SAMPLE), *(pytest.param(seed, marks=pytest.mark.weekly) for seed in (1, 2))],
)
def proofs(request: pytest.FixtureRequest) -> Proofs:
    whole = [corpus.load(name, ROOT) for name in (*EXERCISES, *DRILLS)]
    is_sample = request.param == SAMPLE
    chosen = [sample(one) for one in whole] if is_sample else whole
    with Gradings([one.task for one in chosen]) as pool:
        reports = check.grade(pool, chosen, 1 if is_sample else request.param)
    found = [
        fault
        for one in chosen
        for fault in rules.faults(one, reports)
        if not is_sample or fault.submission  # what holds of all together needs all
    ]
    return Proofs(whole, reports, found)

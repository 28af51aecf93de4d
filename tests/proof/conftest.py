"""The submissions that prove the graders are graded once in a test run, as `course-kit dev check` does it.

The usual run takes a sample of them, `./course test --all` grades each, with two seeds.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.authoring import check, corpus, rules
from course_kit.authoring.gradings import Gradings
from course_kit.grading.engine import GradingRequest
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.catalogue import catalogue

if TYPE_CHECKING:
    from course_kit.grading import Report

ROOT = environment.checkout_folder() or Path()
EXERCISES = corpus.all_exercises(ROOT)
DRILLS = sorted(exercise_folders.find_exercises(ROOT / "exercises").drills)
SAMPLE = "sample"
ONE_IN = 6  # of the right programs beside the solutions
SIDE_BY_SIDE = 4  # fewer than a class has: other tests run beside these
CONVERSATIONS = ("temperature_service", "move_robot", "robot_parameters", "delivery_robot")


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


class SampleGradings(Gradings):
    """Gradings of a wrong program end with its first failure where no more of its verdict is compared."""

    def request_for(self, submission: corpus.ProofSubmission, seed: int) -> GradingRequest | Report:
        request = super().request_for(submission, seed)
        if isinstance(request, GradingRequest) and is_compared_in_short(submission):
            return replace(request, first_failure=True)
        return request


def is_compared_in_short(one: corpus.ProofSubmission) -> bool:
    """What hangs on what a conversation drew, or on which program is late, is for `--all`; what a stub earns is not."""
    return one.exercise in CONVERSATIONS and one.kind in ("broken", "slip") and not one.name.startswith("stub_")


def sample(whole: list[corpus.Corpus]) -> list[corpus.Corpus]:
    """A starter, the solution and stubs of each, other right programs, each diagnosis once, a failure of each check."""
    every = [one for each in whole for one in sorted(each.submissions, key=lambda one: zlib.crc32(one.name.encode()))]
    right = [one for one in every if one.kind == "variant" or (one.kind == "slip" and not one.failed)]
    told: set[str] = set()
    chosen = []
    for one in whole:
        starters = [each for each in one.of_kind("starter") if each.path.suffix != ".py"]
        here = {*right[::ONE_IN], *one.of_kind("solution"), *starters}
        # pattern_choice, which has no node, fails in ways of its own.
        named = [each for each in (*one.of_kind("broken"), *one.of_kind("slip")) if each.name in catalogue()]
        here.update(each for each in named if each.name not in told or each.exercise == "pattern_choice")
        told.update(each.name for each in named)
        seen = {"offered", *(check for each in here if each.exercise == one.exercise.id for check, _ in each.failed)}
        for each in sorted(one.of_kind("slip"), key=lambda each: (each.name not in catalogue(), each.name)):
            checks = {check for check, _ in each.failed}
            if not checks <= seen:
                here.add(each)
                seen |= checks
        here.update(each for each in one.of_kind("slip") if each.name.startswith("stub_"))
        chosen.append(corpus.Corpus(one.exercise, tuple(each for each in one.submissions if each in here)))
    return chosen


@pytest.fixture(
    scope="session",
    params=[pytest.param(SAMPLE, id=SAMPLE), *(pytest.param(seed, marks=pytest.mark.weekly) for seed in (1, 2))],
)
def proofs(request: pytest.FixtureRequest) -> Proofs:
    whole = [corpus.load_corpus(name, ROOT) for name in (*EXERCISES, *DRILLS)]
    is_sample = request.param == SAMPLE
    chosen = sample(whole) if is_sample else whole
    exercises = [one.exercise for one in chosen]
    with SampleGradings(exercises, SIDE_BY_SIDE) if is_sample else Gradings(exercises) as pool:
        reports = check.grade_corpora(pool, chosen, 1 if is_sample else request.param)
    found = [
        fault
        for one in chosen
        for fault in rules.find_faults(one, reports)
        if not is_sample or fault.submission  # what holds of all together needs all
    ]
    return Proofs(whole, reports, found)

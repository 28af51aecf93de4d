"""Every submission is graded once in a test run: `course-kit dev check` is what does it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.authoring import check, corpus
from course_kit.grading import Report, exercise_folders

ROOT = environment.checkout() or Path()
EXERCISES = corpus.all_exercises(ROOT)
DRILLS = sorted(exercise_folders.drills(ROOT / "exercises"))


@dataclass
class Proofs:
    """What `dev check` finds of all exercises and drills, with one seed."""

    outcome: check.ProofOutcome

    @property
    def reports(self) -> dict[corpus.ProofSubmission, Report]:
        return self.outcome.runs[0].reports

    def of(self, exercise: str, name: str, *kinds: str) -> Report:
        """The report of the submission of that name, wrong or of one of these kinds."""
        found = (one for one in self.reports if (one.exercise, one.name) == (exercise, name))
        return next(self.reports[one] for one in found if one.kind in (kinds or ("broken", "slip")))


@pytest.fixture(scope="session", params=[1, pytest.param(2, marks=pytest.mark.weekly)], ids="seed {}".format)
def proofs(request: pytest.FixtureRequest) -> Proofs:
    return Proofs(check.check(ROOT, [*EXERCISES, *DRILLS], seed=request.param))

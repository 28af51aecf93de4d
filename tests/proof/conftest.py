"""Each exercise is proven once in a test run: `course-kit dev check` is what does it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.authoring import check, corpus

ROOT = environment.checkout() or Path()
EXERCISES = corpus.all_exercises(ROOT)


class Proofs:
    """What `dev check` finds, exercise by exercise, as the tests ask for it."""

    @cache  # noqa: B019 - it lives as long as the test run
    def of(self, exercise: str) -> check.ProofOutcome:
        return check.check(ROOT, [exercise])

    def report(self, exercise: str, kind: str, name: str) -> check.Report:
        reports = self.of(exercise).runs[0].reports
        return next(report for one, report in reports.items() if (one.kind, one.name) == (kind, name))


@pytest.fixture(scope="session")
def proofs() -> Proofs:
    return Proofs()

"""Each exercise is proven once in a test run: `course-kit dev check` is what does it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.authoring import check, corpus

ROOT = environment.checkout() or Path()
EXERCISES = corpus.all_exercises(ROOT)


class Proofs:
    """What `dev check` finds of all exercises in one run, so that no worker waits for the last of an exercise."""

    @cache  # noqa: B019 - it lives as long as the test run
    def _of_all(self) -> check.ProofOutcome:
        return check.check(ROOT, EXERCISES)

    @cache  # noqa: B019 - as above
    def of(self, exercise: str) -> check.ProofOutcome:
        found = self._of_all()
        (run,) = found.runs
        reports = {one: report for one, report in run.reports.items() if one.exercise == exercise}
        return replace(
            found,
            sets=tuple(one for one in found.sets if one.task.id == exercise),
            runs=(replace(run, reports=reports),),
            faults=tuple(one for one in found.faults if one.exercise == exercise),
        )

    def report(self, exercise: str, kind: str, name: str) -> check.Report:
        reports = self.of(exercise).runs[0].reports
        return next(report for one, report in reports.items() if (one.kind, one.name) == (kind, name))


@pytest.fixture(scope="session")
def proofs() -> Proofs:
    return Proofs()

"""Faults that a teacher would think of cost points, and right programs in odd styles none, each in three gradings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.grading.model.exercise import load_exercise
from tests.proof import fault_tables

if TYPE_CHECKING:
    from course_kit.authoring.corpus import ProofSubmission

SEEDS = (1, 2, 3)
MAY_BE_MISSED = 2  # of 60 in each exercise
TABLES = [(name, kind) for name in fault_tables.EXERCISES for kind in ("fault", "right")]
pytestmark = pytest.mark.answers


@pytest.mark.parametrize(("name", "kind"), TABLES)
def test_each_program_of_a_table_compiles_and_names_sentences_of_the_task(name: str, kind: str) -> None:
    found = fault_tables.programs(name, kind)
    known = {sentence.id for sentence in load_exercise(name).sentences}
    assert len({str(one.texts()) for one in found}) == len(found) >= {"fault": 60, "right": 40}[kind]
    for one in found:
        compile(one.texts()[one.path.name], one.name, "exec")
        assert bool(one.breaks) == (kind == "fault")
        assert set(one.breaks) <= known


@pytest.mark.weekly
@pytest.mark.timeout(1800)
@pytest.mark.parametrize(("name", "kind"), TABLES)
def test_each_fault_costs_points_and_no_right_program_does(name: str, kind: str) -> None:
    bad = said_of(fault_tables.programs(name, kind))
    assert len(bad) <= (MAY_BE_MISSED if kind == "fault" else 0), "\n".join(bad)


def said_of(programs: list[ProofSubmission]) -> list[str]:
    verdicts = fault_tables.grade_all(programs, SEEDS)
    return [f"{one.program.name}: {'; '.join(said)}" for one in verdicts if (said := one.complaints())]

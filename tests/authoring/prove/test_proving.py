"""What a grader lets through is named, and what it sees is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.prove import proving
from course_kit.grading import GradingError

if TYPE_CHECKING:
    from tests.authoring.prove.conftest import Tiny

LINE = '"high": 5,'


def text(proof: proving.GraderProof) -> str:
    return "\n".join(proving.describe_proof(proof, quick=False))


def test_a_grader_that_sees_everything_is_proven(tiny: Tiny) -> None:
    proof = tiny.prove()
    assert (proof.survivors, proof.problems, proof.equivalent) == ([], [], [])
    assert proof.graded == proof.made > 8
    assert proof.holds
    assert "PROVEN." in text(proof)


def test_a_mistake_that_gets_full_marks_is_named(tiny: Tiny) -> None:
    tiny.grader(high="got in (5, 6)")
    proof = tiny.prove()
    assert [one.change for one in proof.survivors] == ["5 -> 6"]
    assert not proof.holds
    assert "tiny.py, line 3: another number" in text(proof)
    assert f"    {LINE}\n    5 -> 6\n" in text(proof)
    assert "NOT PROVEN" in text(proof)


def test_a_declared_one_needs_no_more_than_its_reason(tiny: Tiny) -> None:
    tiny.grader(high="got in (5, 6)")
    entry = (
        "[[equivalent]]\nlines = ['{}']\noperators = [\"another number\"]\nchange = '{}'\nreason = \"Six will do.\"\n"
    )
    tiny.declare(entry.format(LINE, "-> 6"))
    proof = tiny.prove()
    assert proof.holds
    assert [one.change for one in proof.equivalent] == ["5 -> 6"]
    tiny.declare(entry.format(LINE, "-> 4"))
    proof = tiny.prove()
    assert not proof.holds
    assert "Declared as equivalent, but high sees it: another number" in text(proof)
    tiny.declare(entry.format("limits = {}", ""))
    assert "this mutant no longer exists: another number: limits = {}" in text(tiny.prove())


def test_a_solution_without_full_marks_proves_nothing(tiny: Tiny) -> None:
    tiny.grader(high="got == 6")
    with pytest.raises(GradingError, match=r"the solution itself does not get full marks: 1 of 2 points.*It is not 5"):
        tiny.prove()

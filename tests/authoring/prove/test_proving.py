"""What a grader lets through is named, and what it sees is not; right programs, and chance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.prove import table
from course_kit.authoring.prove.outcome import EQUIVALENT, SEEN, SURVIVED
from course_kit.grading import GradingError

if TYPE_CHECKING:
    from tests.authoring.prove.conftest import Tiny

LINE = '"high": 5,'


def test_a_grader_that_sees_everything_is_proven(tiny: Tiny) -> None:
    proof = tiny.prove()
    assert table.problems(proof) == []
    assert [one.mutant.key for one in proof.of(SURVIVED)] == []
    assert len(proof.of(SEEN)) == len(proof.mutants) > 8
    assert proof.holds
    assert "PROVEN." in table.as_text(proof)
    assert [one.name for one in proof.variants] == ["the solution", "entries in another order", "made by a function"]


def test_a_mistake_that_gets_full_marks_is_named_with_the_sentence(tiny: Tiny) -> None:
    tiny.grader(high="got in (5, 6)")
    proof = tiny.prove()
    assert [one.mutant.after for one in proof.of(SURVIVED)] == ['"high": 6,']
    assert not proof.holds
    text = table.as_text(proof)
    assert "tiny.py, line 3: another number" in text
    assert f"    -    {LINE}\n    +" in text
    assert "high_is_five: The high limit is 5." in text
    assert "NOT PROVEN" in text


def test_a_declared_one_needs_no_more_than_its_reason(tiny: Tiny) -> None:
    tiny.grader(high="got in (5, 6)")
    entry = (
        "[[equivalent]]\nlines = ['{}']\noperators = [\"another number\"]\nchange = '{}'\nreason = \"Six will do.\"\n"
    )
    tiny.declare(entry.format(LINE, '"high": 6'))
    proof = tiny.prove()
    assert proof.holds
    assert [one.declared.reason for one in proof.of(EQUIVALENT) if one.declared] == ["Six will do."]
    tiny.declare(entry.format(LINE, '"high": 4'))
    proof = tiny.prove()
    assert not proof.holds
    assert "Declared as equivalent, but high sees it: another number" in table.as_text(proof)
    tiny.declare(entry.format("limits = {}", ""))
    assert "there is no such mutant any more: another number: limits = {}" in table.as_text(tiny.prove())


def test_a_right_program_that_is_rejected_is_named(tiny: Tiny) -> None:
    tiny.grader(high="got == 5 and context.job.literal is not None")
    proof = tiny.prove()
    assert not proof.holds
    problems = " ".join(table.problems(proof))
    assert "rejects a right program: made by a function gets high failed. It is not 5." in problems


def test_a_verdict_that_differs_from_one_time_to_the_next_is_named(tiny: Tiny) -> None:
    """The grader here takes the solution twice: a file marks that it has been there."""
    counts = "got == 5 and (HERE / 'seen').open('a').write('x') and (HERE / 'seen').stat().st_size <= 3"
    tiny.grader(low="got == 2", high=counts)
    proof = tiny.prove(repeat=2)
    assert [one.name for one in proof.variants if one.flaky]
    assert "differs from one time to the next: full marks; high failed" in " ".join(table.problems(proof))
    assert not proof.holds


def test_a_solution_without_full_marks_proves_nothing(tiny: Tiny) -> None:
    tiny.grader(high="got == 6")
    with pytest.raises(GradingError, match=r"the solution itself does not get full marks: 1 of 2 points.*It is not 5"):
        tiny.prove()


@pytest.mark.parametrize(("text", "said"), [("limits = {", "is not Python: line 1"), (None, "There is no solution")])
def test_a_solution_that_cannot_be_used(tiny: Tiny, text: str | None, said: str) -> None:
    tiny.places.solution.unlink()
    if text is not None:
        tiny.places.solution.write_text(text)
    with pytest.raises(GradingError, match=said):
        tiny.prove()

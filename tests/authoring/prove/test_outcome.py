"""What has become of a mutant, by its verdicts; and where the files of a proof lie."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.prove import mutants, places
from course_kit.authoring.prove.equivalent import DeclaredEquivalent
from course_kit.authoring.prove.outcome import MutantOutcome, VariantOutcome
from course_kit.authoring.prove.verdicts import Verdict
from course_kit.grading import exercise
from tests import outside_exercises

if TYPE_CHECKING:
    from pathlib import Path

MUTANT = mutants.of("a = b < c")[0]
FULL, SEEN, BROKEN = (
    Verdict(full_marks=True),
    Verdict(full_marks=False, failed=("one",)),
    Verdict(False, problem="ended"),
)
DECLARED = DeclaredEquivalent("a = b < c", MUTANT.operator, "It may.")


@pytest.mark.parametrize(
    ("outcome", "state"),
    [
        (MutantOutcome(MUTANT), "not graded"),
        (MutantOutcome(MUTANT, (BROKEN,)), "not graded"),
        (MutantOutcome(MUTANT, (SEEN,)), "seen"),
        (MutantOutcome(MUTANT, (SEEN, BROKEN)), "seen"),
        (MutantOutcome(MUTANT, (FULL, FULL)), "survived"),
        (MutantOutcome(MUTANT, (FULL, SEEN)), "by chance"),
        (MutantOutcome(MUTANT, (FULL, SEEN), sees_any=True), "seen"),
        (MutantOutcome(MUTANT, (FULL,), wanted=2), "not graded"),
        (MutantOutcome(MUTANT, (FULL,), DECLARED), "equivalent"),
        (MutantOutcome(MUTANT, (SEEN,), DECLARED), "seen"),
    ],
)
def test_what_has_become_of_a_mutant(outcome: MutantOutcome, state: str) -> None:
    assert outcome.state == state


def test_a_right_program() -> None:
    assert not VariantOutcome("a", (FULL, FULL, BROKEN)).flaky
    assert not VariantOutcome("a", (FULL, BROKEN)).rejected
    assert VariantOutcome("a", (FULL, SEEN)).flaky
    assert VariantOutcome("a", (SEEN, SEEN)).rejected
    assert not VariantOutcome("a", (SEEN, SEEN)).flaky


def test_files_of_an_exercise_of_another_folder_and_of_our_own(tmp_path: Path) -> None:
    folder = outside_exercises.write(tmp_path)
    found = places.of(exercise.read(folder))
    assert found.solution == folder / "solution" / "add_three.py"
    assert found.declared == folder / "proof" / "equivalent.toml"
    ours = places.of(exercise.load("move_robot"))
    assert ours.declared == ours.solution.parent / "equivalent.toml"
    assert ours.declared.is_file()

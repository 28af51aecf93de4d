"""Where an exercise's solution lies, and what is declared about it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.prove import equivalent

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise


@dataclass(frozen=True)
class ProofPlaces:
    """The files of one proof.

    Attributes:
        solution: the solution, which has to be there.
        declared: the mutants that are declared as equivalent; it need not be there.
    """

    solution: Path
    declared: Path


def of(exercise: Exercise) -> ProofPlaces:
    """The files of an exercise; its declarations lie in its own proof set, or else beside its solution."""
    own = exercise.solution.is_relative_to(exercise.folder)
    declared = (exercise.folder / "proof" if own else exercise.solution.parent) / equivalent.FILE
    return ProofPlaces(exercise.solution, declared)

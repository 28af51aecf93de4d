"""Where an exercise's solution lies, what is declared about it, and where verdicts are kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.authoring.prove import equivalent

if TYPE_CHECKING:
    from course_kit.grading.exercise import Exercise


@dataclass(frozen=True)
class ProofPlaces:
    """The files of one proof.

    Attributes:
        solution: the solution, which has to be there.
        declared: the mutants that are declared as equivalent; it need not be there.
        store: the verdicts, for a run that was stopped.
    """

    solution: Path
    declared: Path
    store: Path


def of(exercise: Exercise) -> ProofPlaces:
    """The files of an exercise; its declarations lie in its own proof set, or else beside its solution."""
    solution = _solution(exercise)
    own = solution.is_relative_to(exercise.folder)
    declared = (exercise.folder / "proof" if own else solution.parent) / equivalent.FILE
    return ProofPlaces(solution, declared, environment.state_dir() / "prove" / f"{exercise.id}.jsonl")


def _solution(exercise: Exercise) -> Path:
    named = getattr(exercise, "solution", None)
    if isinstance(named, Path):
        return named
    root = environment.checkout() or exercise.folder.parent.parent
    return root / "solutions" / exercise.id / f"{exercise.id}.py"

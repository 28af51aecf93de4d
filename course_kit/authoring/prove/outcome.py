"""What `prove` has found out about a grader."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from course_kit.authoring.prove.equivalent import DeclaredEquivalent
    from course_kit.authoring.prove.mutants import Mutant
    from course_kit.authoring.prove.verdicts import Verdict
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.report import CheckReport

SEEN, SURVIVED, EQUIVALENT, BY_CHANCE, NOT_GRADED = "seen", "survived", "equivalent", "by chance", "not graded"
_MOST_CHECKS = 2  # that are said to be about a line


@dataclass(frozen=True)
class MutantOutcome:
    """What has become of a mutant.

    Attributes:
        mutant: which.
        verdicts: one for each seed it was graded with.
        declared: what its author says about it.
        sees_any: whether one seed that sees it is enough, as where each draws other questions.
        wanted: the number of verdicts from which it counts that none sees it.
    """

    mutant: Mutant
    verdicts: tuple[Verdict, ...] = ()
    declared: DeclaredEquivalent | None = None
    sees_any: bool = False
    wanted: int = 1

    @property
    def state(self) -> str:
        """One of the words above."""
        graded = [one for one in self.verdicts if not one.problem]
        if not graded:
            return NOT_GRADED
        if any(not one.full_marks for one in graded):
            return SEEN if self.sees_any or not any(one.full_marks for one in graded) else BY_CHANCE
        if len(graded) < self.wanted:
            return NOT_GRADED
        return EQUIVALENT if self.declared else SURVIVED

    @property
    def seen_by(self) -> tuple[str, ...]:
        """The ids of the checks that it fails, each once."""
        return tuple(dict.fromkeys(name for one in self.verdicts for name in one.failed))


@dataclass(frozen=True)
class VariantOutcome:
    """The verdicts on a program that is right: the solution, or one made from it; the first without load."""

    name: str
    verdicts: tuple[Verdict, ...]

    @property
    def rejected(self) -> bool:
        """Whether it has missed full marks."""
        return any(not one.full_marks and not one.problem for one in self.verdicts)

    @property
    def flaky(self) -> bool:
        """Whether the verdicts differ."""
        return len({(one.full_marks, one.failed) for one in self.verdicts if not one.problem}) > 1


@dataclass(frozen=True)
class GraderProof:
    """All that was found out.

    Attributes:
        exercise: the exercise.
        solution: its solution.
        source: the solution's text.
        checks: the checks, as they were run on the solution.
        mutants: what has become of each.
        variants: the same of the solution and of right programs made from it.
        unused: declarations that are about no mutant that there is.
        seed: what the first gradings drew from.
        duration_s: seconds on the wall.
        quick: not all mutants were graded, and nothing was repeated.
    """

    exercise: Exercise
    solution: Path
    source: str
    checks: tuple[CheckReport, ...]
    mutants: tuple[MutantOutcome, ...]
    variants: tuple[VariantOutcome, ...]
    unused: tuple[DeclaredEquivalent, ...] = ()
    seed: int = 1
    duration_s: float = 0.0
    quick: bool = False
    _near: dict[int, tuple[str, ...]] = field(default_factory=dict, compare=False)

    def of(self, state: str) -> list[MutantOutcome]:
        """The mutants of which this has become."""
        return [one for one in self.mutants if one.state == state]

    @property
    def wrongly_declared(self) -> list[MutantOutcome]:
        """Mutants that are declared as equivalent, and that the grader sees."""
        return [one for one in self.mutants if one.declared and one.state in (SEEN, BY_CHANCE)]

    @property
    def holds(self) -> bool:
        """Whether nothing was found: no survivor without a reason, no right program rejected, no verdict varies."""
        wrong = any(one.rejected or one.flaky for one in self.variants)
        return not (wrong or self.of(SURVIVED) or self.of(BY_CHANCE) or self.wrongly_declared or self.unused)

    def checks_about(self, mutant: Mutant) -> tuple[str, ...]:
        """The ids of the checks that see other mistakes on its line, else in those beside it; the most frequent first.

        A program that does not even start fails the first check; that tells nothing, unless it is the only one.
        """
        if mutant.line not in self._near:
            same = self._count([mutant.line])
            self._near[mutant.line] = same or self._count([mutant.line - 1, mutant.line + 1])
        return self._near[mutant.line]

    def sentences_about(self, mutant: Mutant) -> list[str]:
        """The ids of the sentences of the task that these checks prove."""
        proves: Mapping[str, Sequence[str]] = {one.id: one.proves for one in self.checks}
        return list(dict.fromkeys(name for check in self.checks_about(mutant) for name in proves.get(check, ())))

    def _count(self, lines: Iterable[int]) -> tuple[str, ...]:
        wanted = set(lines)
        counted = Counter(name for one in self.mutants if one.mutant.line in wanted for name in one.seen_by)
        first = self.checks[0].id if self.checks else ""
        others = Counter({name: number for name, number in counted.items() if name != first})
        return tuple(name for name, _ in (others or counted).most_common(_MOST_CHECKS))

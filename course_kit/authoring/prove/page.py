"""The proof as a page: the solution's lines, coloured by what sees mistakes in them. Nothing of it is fetched."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.authoring.prove import table
from course_kit.authoring.prove.outcome import BY_CHANCE, EQUIVALENT, NOT_GRADED, SEEN, SURVIVED
from course_kit.text.templates import render

if TYPE_CHECKING:
    from course_kit.authoring.prove.outcome import GraderProof, MutantOutcome

_TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class ShownMutant:
    """A mutant as the page shows it."""

    operator: str
    diff: tuple[str, ...]
    about: tuple[str, ...]


@dataclass(frozen=True)
class ProofLine:
    """A line of the solution.

    Attributes:
        number: from 1.
        text: as it is written.
        colour: a class of the style sheet: `survived`, `equivalent`, `seen` or nothing, where no mistake was made.
        seen: how many mistakes are seen.
        checks: the ids of the checks that see them.
        survivors: those that nobody sees and nobody explains.
        declared: those that are declared as equivalent, with the reasons.
        ungraded: how many mistakes were not graded.
    """

    number: int
    text: str
    colour: str
    seen: int
    checks: tuple[str, ...]
    survivors: tuple[ShownMutant, ...]
    declared: tuple[ShownMutant, ...]
    ungraded: int


def render_proof(proof: GraderProof) -> str:
    """The page, as an HTML document."""
    titles = {check.id: check.title for check in proof.checks}
    return str(
        render(
            _TEMPLATES / "proof.html",
            title=proof.exercise.title,
            exercise=proof.exercise.id,
            solution=proof.solution.name,
            holds=proof.holds,
            quick=proof.quick,
            counts={state: len(proof.of(state)) for state in (SEEN, SURVIVED, BY_CHANCE, EQUIVALENT, NOT_GRADED)},
            problems=table.problems(proof),
            lines=lines_of(proof),
            titles=titles,
            variants=proof.variants,
            seed=proof.seed,
        )
    )


def lines_of(proof: GraderProof) -> list[ProofLine]:
    """The solution's lines, each with what has become of the mistakes made in it."""
    by_line: dict[int, list[MutantOutcome]] = {}
    for one in proof.mutants:
        by_line.setdefault(one.mutant.line, []).append(one)
    texts = proof.source.rstrip("\n").split("\n")
    return [_line(proof, number, text, by_line.get(number, [])) for number, text in enumerate(texts, start=1)]


def _line(proof: GraderProof, number: int, text: str, made: list[MutantOutcome]) -> ProofLine:
    survivors = [one for one in made if one.state in (SURVIVED, BY_CHANCE)]
    declared = [one for one in made if one.state == EQUIVALENT]
    seen = [one for one in made if one.state == SEEN]
    groups = (("survived", survivors), ("seen", seen), ("equivalent", declared))
    return ProofLine(
        number=number,
        text=text,
        colour=next((name for name, group in groups if group), ""),
        seen=len(seen),
        checks=tuple(dict.fromkeys(name for one in seen for name in one.seen_by)),
        survivors=tuple(
            ShownMutant(one.mutant.operator, one.mutant.diff, tuple(table.about(proof, one))) for one in survivors
        ),
        declared=tuple(
            ShownMutant(one.mutant.operator, one.mutant.diff, (one.declared.reason,) if one.declared else ())
            for one in declared
        ),
        ungraded=sum(one.state == NOT_GRADED for one in made),
    )

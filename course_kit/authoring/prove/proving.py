"""Grades the mutants of a solution by the pool that grades a class, and says which get full marks."""

from __future__ import annotations

import random
import sys
import time
from dataclasses import dataclass, field
from textwrap import shorten
from typing import TYPE_CHECKING

from course_kit.authoring.gradings import Gradings
from course_kit.authoring.prove import mutants
from course_kit.authoring.rules import describe_report
from course_kit.grading.errors import GradingError
from course_kit.text.console import wrap_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.authoring.prove.mutants import DeclaredEquivalent, Mutant
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report

_MORE_SEEDS = 2  # for a mutant that gets full marks with the first one
_SEEDS_OF_ANSWERS = 40  # where each draws other questions: so many that a question that is never drawn is unlikely
_SAMPLE = 60  # mutants of --quick
_EACH = 50  # gradings from one line of progress to the next
_WIDTH = 100
_TINY = 1e-6  # points


@dataclass(frozen=True)
class GraderProof:
    """What was found out about the grader of an exercise."""

    exercise: Exercise  # the exercise
    made: int = 0  # how many mistakes there are in its solution
    graded: int = 0  # how many were graded
    # those that get full marks with each seed, and are not declared as equivalent
    survivors: list[Mutant] = field(default_factory=list)
    equivalent: list[Mutant] = field(default_factory=list)  # those that get full marks, as declared
    problems: list[str] = field(default_factory=list)  # what does not hold beside the survivors, a sentence each
    duration_s: float = 0.0  # seconds on the wall

    @property
    def holds(self) -> bool:
        """Whether nothing was found."""
        return not self.survivors and not self.problems


def prove_grader(exercise: Exercise, *, quick: bool = False, seed: int = 1, workers: int | None = None) -> GraderProof:
    """Find out what a grader lets through."""
    began = time.monotonic()
    texts = _read_solution(exercise)
    starts_itself = exercise.practice or not exercise.class_name
    programs = [name for name in texts if name.endswith(".py") and name != exercise.launch_file]
    made = [
        mutant
        for name in programs
        for mutant in mutants.make_mutants(texts[name], starts_itself=starts_itself, file=name)
    ]
    entries = mutants.read_equivalents(mutants.file_of(exercise))
    declared = {mutant: entry for mutant in made for entry in entries if entry.covers(mutant)}
    chosen = random.Random(seed).sample(made, min(_SAMPLE, len(made))) if quick else made  # noqa: S311 - no secret
    more = 0 if quick else _SEEDS_OF_ANSWERS if exercise.variable else _MORE_SEEDS
    left, problems = list(chosen), _name_unused(entries, made)
    with Gradings([exercise], workers) as pool:
        [(_, report)] = pool.grade_all([("", pool.request_for_program(exercise.id, texts, seed))])
        if not _has_full_marks(report):
            raise GradingError(
                f"Nothing can be proven, because the solution itself does not get full marks: {describe_report(report)}"
            )
        for each in range(seed, seed + more + 1):
            reports = _grade(pool, (exercise.id, texts), left, each)
            problems += list(_name_failures(reports, declared))
            left = [mutant for mutant in left if _has_full_marks(reports[mutant])]
            if each == seed and not exercise.variable:
                agreed = [mutant for mutant in left if mutant in declared]
                left = [mutant for mutant in left if mutant not in declared]
    return GraderProof(
        exercise=exercise,
        made=len(made),
        graded=len(chosen),
        survivors=[mutant for mutant in left if mutant not in declared],
        equivalent=[mutant for mutant in left if mutant in declared] if exercise.variable else agreed,
        problems=problems,
        duration_s=time.monotonic() - began,
    )


def _grade(
    pool: Gradings, solution: tuple[str, dict[str, str]], programs: Sequence[Mutant], seed: int
) -> dict[Mutant, Report]:
    """Grade mutants side by side, until the first check that fails, and tell on stderr how far it is."""
    exercise_id, texts = solution
    requests = (
        (path, pool.request_for_program(exercise_id, {**texts, path.file: path.source}, seed, first_failure=True))
        for path in programs
    )
    reports: dict[Mutant, Report] = {}
    for mutant, report in pool.grade_all(requests):
        reports[mutant] = report
        if len(reports) % _EACH == 0 or len(reports) == len(programs):
            sys.stderr.write(f"[{len(reports)}/{len(programs)}] mistakes graded with seed {seed}\n")
            sys.stderr.flush()
    return reports


def describe_proof(proof: GraderProof, *, quick: bool) -> Iterator[str]:
    """What was found, in lines, the survivors first."""
    if proof.survivors:
        yield from ("Mistakes that get full marks, with no reason given:", "")
    for mutant in proof.survivors:
        yield f"{mutant.file}, line {mutant.line}: {mutant.operator}"
        yield from (f"    {mutant.before}", f"    {shorten(mutant.change, _WIDTH)}", "")
    for problem in proof.problems:
        yield from wrap_text(f"✗ {problem}", following="    ", width=_WIDTH)
    seen = proof.graded - len(proof.survivors) - len(proof.equivalent)
    yield (
        f"{proof.exercise.id}: {proof.graded} of {proof.made} mistakes graded: {seen} seen, "
        f"{len(proof.survivors)} survived, {len(proof.equivalent)} declared as equivalent."
    )
    held = "A sample was graded, and nothing was found." if quick else "PROVEN."
    yield f"{held if proof.holds else 'NOT PROVEN.'} ({proof.duration_s:.0f} s)"


def _name_unused(entries: Sequence[DeclaredEquivalent], made: Sequence[Mutant]) -> list[str]:
    return [
        f"Declared as equivalent, but this mutant no longer exists: {entry}. Take it out, or adapt it."
        for entry in entries
        if not any(entry.covers(mutant) for mutant in made)
    ]


def _name_failures(reports: dict[Mutant, Report], declared: dict[Mutant, DeclaredEquivalent]) -> Iterator[str]:
    """Mutants that could not be graded, and those that a check sees though they are declared as equivalent."""
    for mutant, report in reports.items():
        if report.status in ("error", "unreadable"):
            yield f"Not graded: {mutant.key}. {report.problem}"
        elif mutant in declared and not _has_full_marks(report):
            seen = " and ".join(check.id for check in report.checks if check.status == "failed")
            yield f"Declared as equivalent, but {seen} sees it: {mutant.key}. Take it out of the declarations."


def _has_full_marks(report: Report) -> bool:
    return report.status == "graded" and report.score >= report.max_score - _TINY


def _read_solution(exercise: Exercise) -> dict[str, str]:
    """The files of the solution, by name; each program in which mistakes are made is one."""
    solution = exercise.solution
    paths = [solution / name for name in exercise.files] or [solution]
    texts = {}
    try:
        for path in paths:
            texts[path.name] = path.read_text(encoding="utf-8")
            if path.suffix == ".py":
                compile(texts[path.name], path.name, "exec", dont_inherit=True)
    except FileNotFoundError:
        raise GradingError(f"There is no solution {path}, in which mistakes could be made.") from None
    except (OSError, SyntaxError, ValueError) as problem:
        raise GradingError(f"{path} is no program: {problem}.") from None
    return texts

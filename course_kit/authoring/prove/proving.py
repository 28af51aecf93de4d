"""Makes every small mistake in a solution, each once, grades these mutants, and says which get full marks.

Those that are right an author has declared in `equivalent.toml`; AUTHORING.md has its form. With `ordinal` an entry is
about the first, second ... of several alike.
"""

from __future__ import annotations

import ast
import random
import re
import sys
import time
from collections import Counter
from dataclasses import dataclass, field
from textwrap import shorten
from typing import TYPE_CHECKING

import msgspec

from course_kit.authoring.gradings import Gradings
from course_kit.authoring.prove import mistakes, ros_mistakes
from course_kit.authoring.prove.program import ParsedProgram, line_of
from course_kit.authoring.rules import describe_report
from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import LAUNCH_FILE
from course_kit.text.console import wrap_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.authoring.prove.program import New
    from course_kit.grading.model.exercise import Exercise
    from course_kit.grading.model.report import Report

FILE = "equivalent.toml"
_MORE_SEEDS = 2  # for a mutant that gets full marks with the first one
_SEEDS_OF_ANSWERS = 40  # where each draws other questions: so many that a question that is never drawn is unlikely
_SAMPLE = 60  # mutants of --quick
_EACH = 50  # gradings from one line of progress to the next
_WIDTH = 100
_TINY = 1e-6  # points


@dataclass(frozen=True)
class Mutant:
    """A solution with one mistake."""

    operator: str  # what kind of mistake
    line: int  # where, from 1
    before: str  # that line, without blanks around it
    change: str  # `old -> new`, as `ast` writes both
    ordinal: int  # which of those with the same three, from 1
    source: str  # the whole program
    file: str = ""  # its name, as the solution has it

    @property
    def key(self) -> str:
        """Its name, which stays the same when lines are added above it."""
        more = f" (no. {self.ordinal})" if self.ordinal > 1 else ""
        return f"{self.operator}: {self.before}: {self.change}{more}"


def make_mutants(source: str, *, starts_itself: bool = True, file: str = "") -> list[Mutant]:
    """All mutants of a program, in the order of its lines; without those that nobody can see."""
    program = ParsedProgram(source, starts_itself=starts_itself)
    lines = source.split("\n")
    seen = {"", ast.unparse(program.tree)}
    found: list[Mutant] = []
    counted: Counter[tuple[str, str, str]] = Counter()
    changes = [change for operator in (*ros_mistakes.MISTAKES, *mistakes.MISTAKES) for change in operator(program)]
    for change in sorted(changes, key=lambda change: line_of(change.at or change.node)):
        text = program.text_with(change)
        if text in seen:
            continue
        seen.add(text)
        line = line_of(change.at or change.node)
        mistake = change.operator, lines[line - 1].strip(), f"{_write_node(change.node)} -> {_write_node(change.new)}"
        counted[mistake] += 1
        found.append(Mutant(change.operator, line, *mistake[1:], counted[mistake], text, file))
    return found


def _write_node(node: ast.AST | New) -> str:
    """A node in one line."""
    if node is None:
        return "nothing"
    parts = node if isinstance(node, list) else [node]
    return " / ".join(line.strip() for part in parts for line in ast.unparse(part).split("\n"))


class _Entry(msgspec.Struct, forbid_unknown_fields=True):
    lines: list[str]
    operators: list[str]
    reason: str
    change: str = ""
    ordinal: int = 0


@dataclass(frozen=True)
class DeclaredEquivalent:
    """One operator on one line; `change` is empty and `ordinal` 0 where they are left open."""

    line: str
    operator: str
    change: str = ""
    ordinal: int = 0

    def covers(self, mutant: Mutant) -> bool:
        """Whether it is about a mutant."""
        return (
            mutant.operator == self.operator
            and mutant.before == self.line
            and self.change in mutant.change
            and self.ordinal in (0, mutant.ordinal)
        )

    def __str__(self) -> str:
        return f"{self.operator}: {self.line}{f': {self.change}' if self.change else ''}"


def file_of(exercise: Exercise) -> Path:
    """The declarations of an exercise, in its own proof set, or else beside its solution; the file need not exist."""
    if exercise.solution.is_relative_to(exercise.folder):
        return exercise.folder / "proof" / FILE
    return (exercise.solution if exercise.files else exercise.solution.parent) / FILE


def read_equivalents(path: Path) -> list[DeclaredEquivalent]:
    """The entries of a file, one for each line and operator; none when it is not there."""
    try:
        entries = msgspec.toml.decode(path.read_bytes(), type=dict[str, list[_Entry]])
    except FileNotFoundError:
        return []
    except (OSError, ValueError) as problem:
        mistake = re.sub(r"`\$\[\.\.\.\]\[(\d+)\]", lambda place: f"`entry {int(place[1]) + 1}", str(problem))
        raise GradingError(f"{path} cannot be used: {mistake}.") from problem
    return [
        DeclaredEquivalent(line.strip(), operator, entry.change, entry.ordinal)
        for entry in entries.get("equivalent", ())
        for line in entry.lines
        for operator in entry.operators
    ]


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
    programs = [name for name in texts if name.endswith(".py") and not name.endswith(LAUNCH_FILE)]
    made = [mutant for name in programs for mutant in make_mutants(texts[name], starts_itself=starts_itself, file=name)]
    entries = read_equivalents(file_of(exercise))
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

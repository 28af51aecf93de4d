"""Grades the mutants of a solution and its right variants, and repeats what must not differ."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from course_kit.authoring import gradings
from course_kit.authoring.prove import equivalent, mutants, variants
from course_kit.authoring.prove.outcome import GraderProof, MutantOutcome, VariantOutcome
from course_kit.authoring.prove.program import ParsedProgram
from course_kit.authoring.prove.verdicts import ProgramGrader, Request, Verdict, verdict_of
from course_kit.authoring.rules import outcome
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from course_kit.authoring.prove.mutants import Mutant
    from course_kit.authoring.prove.places import ProofPlaces
    from course_kit.authoring.prove.variants import RightVariant
    from course_kit.grading.exercise import Exercise
    from course_kit.grading.report import Report

_MORE_SEEDS = 2  # for a mutant that gets full marks with the first one
_SEEDS_OF_ANSWERS = 40  # where each draws other questions: so many that a question that is never drawn is unlikely
_BEGIN_S, _END_S = 40.0, 52.0  # of --quick: when nothing more is begun, and when nothing is waited for
_ANSWERS_AT_MOST = 60  # mutants of --quick where each is graded with many seeds
_SOLUTION = "the solution"


@dataclass(frozen=True)
class HowToProve:
    """The options.

    Attributes:
        quick: take under a minute: a sample of the mutants, nothing repeated.
        seed: what the checks draw from.
        repeat: how often right programs are graded again while the processors are kept busy.
        workers: how many gradings run at a time; as many as fit this machine when 0.
        more_seeds: with how many others a mutant is graded that gets full marks; as many as the exercise needs if None.
    """

    quick: bool = False
    seed: int = 1
    repeat: int = 2
    workers: int = 0
    more_seeds: int | None = None


class ProveWatcher(Protocol):
    """Told how it goes."""

    def begin(self, what: str, total: int) -> None:
        """So many gradings of this kind."""

    def done(self) -> None:
        """One more was graded."""


class _Proving:
    """One run."""

    def __init__(
        self, exercise: Exercise, source: str, grader: ProgramGrader, how: HowToProve, watcher: ProveWatcher
    ) -> None:
        self._exercise, self._source, self._grader = exercise, source, grader
        self._how, self._watcher = how, watcher
        self._began = time.monotonic()

    def of_the_solution(self) -> Report:
        """The report on the solution.

        Raises:
            GradingError: it does not get full marks, so that nothing can be found out.
        """
        report = self._grader.report(Request(_SOLUTION, self._source, self._how.seed))
        if not verdict_of(report).full_marks:
            raise GradingError(
                f"Nothing can be proven, because the solution itself does not get full marks: {outcome(report)}"
            )
        return report

    def verdicts(self, what: str, requests: Sequence[Request], *, sample: bool = False) -> dict[Request, Verdict]:
        """Grade programs.

        Args:
            what: what they are, for who watches.
            requests: the programs.
            sample: with `quick`, only as many as there is time for.
        """
        self._watcher.begin(what, len(requests))
        limits = (self._began + _BEGIN_S, self._began + _END_S) if sample and self._how.quick else (None, None)
        found = {}
        for request, verdict in self._grader.grade(requests, *limits):
            found[request] = verdict
            self._watcher.done()
        return found

    def mutants(self, made: Sequence[Mutant], right: Sequence[RightVariant]) -> dict[str, list[Verdict]]:
        """The verdicts on mutants and variants, by their texts."""
        seed = self._how.seed
        requests = [Request(one.name, one.source, seed) for one in right]
        sample = mutants.evenly(made)[: _ANSWERS_AT_MOST if self._how.quick and self._exercise.variable else None]
        requests += [Request(one.key, one.source, seed, first_failure=True) for one in sample]
        found = self.verdicts("programs", requests, sample=True)
        return {request.source: [verdict] for request, verdict in found.items()}

    def with_other_seeds(self, survivors: Sequence[Mutant], verdicts: dict[str, list[Verdict]]) -> None:
        """Grade what has got full marks again, until it does not, or often enough."""
        left, seed = list(survivors), self._how.seed
        last, at_once = seed + self.more_seeds, 1
        while left and seed < last and not (self._how.quick and time.monotonic() > self._began + _BEGIN_S):
            seeds = range(seed + 1, min(seed + at_once, last) + 1)
            requests = [Request(one.key, one.source, each, first_failure=True) for each in seeds for one in left]
            found = self.verdicts("survivors with other seeds", requests, sample=True)
            for request, verdict in found.items():
                verdicts[request.source].append(verdict)
            left = [one for one in left if all(verdict.full_marks for verdict in verdicts[one.source])]
            seed, at_once = seeds[-1], 2 * at_once

    @property
    def more_seeds(self) -> int:
        """With how many other seeds a mutant is graded that gets full marks."""
        usual = _SEEDS_OF_ANSWERS if self._exercise.variable else _MORE_SEEDS
        return usual if self._how.more_seeds is None else self._how.more_seeds

    def under_load(self, right: Mapping[str, str]) -> dict[str, list[Verdict]]:
        """The verdicts on right programs, by name, while every processor is kept busy."""
        if self._how.quick or not self._how.repeat:
            return {}
        requests = [
            Request(name, source, self._how.seed, repeat=number)
            for number in range(1, self._how.repeat + 1)
            for name, source in right.items()
        ]
        with gradings.load(gradings.processors()):
            found = self.verdicts("right programs on a busy machine", requests)
        again: dict[str, list[Verdict]] = {name: [] for name in right}
        for request, verdict in found.items():
            again[request.name].append(verdict)
        return again


def prove(exercise: Exercise, places: ProofPlaces, how: HowToProve, watcher: ProveWatcher) -> GraderProof:
    """Find out what a grader lets through.

    Args:
        exercise: the exercise.
        places: its files.
        how: the options.
        watcher: told how it goes.

    Raises:
        GradingError: it cannot be done; the text says why.
    """
    began = time.monotonic()
    source = _text(places.solution)
    made, right = mutants.of(source), variants.of(source, own_start=exercise.practice)
    entries = equivalent.read(places.declared)
    with ProgramGrader(exercise, how.workers) as grader:
        run = _Proving(exercise, source, grader, how, watcher)
        report = run.of_the_solution()
        verdicts = run.mutants(made, right)
        by_mutant = {one: next((entry for entry in entries if entry.covers(one)), None) for one in made}
        survivors = [
            one
            for one in made
            if verdicts.get(one.source, [])
            and verdicts[one.source][0].full_marks
            and (by_mutant[one] is None or exercise.variable)
        ]
        run.with_other_seeds(survivors, verdicts)
        programs = {_SOLUTION: source, **{one.name: one.source for one in right}}
        again = run.under_load(programs)
    verdicts[source] = [verdict_of(report)]
    return GraderProof(
        exercise=exercise,
        solution=places.solution,
        source=source,
        checks=report.checks,
        mutants=tuple(
            MutantOutcome(
                one,
                tuple(verdicts.get(one.source, ())),
                by_mutant[one],
                sees_any=bool(exercise.variable),
                wanted=1 + run.more_seeds if exercise.variable else 1,
            )
            for one in made
        ),
        variants=tuple(
            VariantOutcome(name, (*verdicts.get(text, ()), *again.get(name, ()))) for name, text in programs.items()
        ),
        unused=tuple(entry for entry in entries if not any(entry.covers(one) for one in made)),
        seed=how.seed,
        duration_s=time.monotonic() - began,
        quick=how.quick,
    )


def _text(solution: Path) -> str:
    try:
        source = solution.read_text(encoding="utf-8")
        ParsedProgram(source)
    except FileNotFoundError:
        raise GradingError(
            f"There is no solution {solution}: without one there are no mistakes to make in it."
        ) from None
    except SyntaxError as problem:
        raise GradingError(f"{solution} is not Python: line {problem.lineno}: {problem.msg}.") from None
    except (OSError, ValueError) as problem:
        raise GradingError(f"{solution} cannot be read: {problem}.") from None
    return source

"""How `course-kit prove` shows what it does and what it has found."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TextIO

from course_kit.authoring.prove.outcome import BY_CHANCE, EQUIVALENT, NOT_GRADED, SEEN, SURVIVED
from course_kit.text.console import wrapped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.authoring.prove.outcome import GraderProof, MutantOutcome

_WIDTH = 100
_EACH = 50  # gradings from one line of progress to the next, where lines cannot be written over
_UNKNOWN = "(unknown: no check sees a mistake on this line or beside it)"


class ProveProgress:
    """Keeps one line up to date on a terminal, else writes some."""

    def __init__(self, stream: TextIO) -> None:
        """Write to a stream, as stderr."""
        self._stream, self._terminal = stream, stream.isatty()
        self._what, self._total, self.graded, self._all = "", 0, 0, 0

    def begin(self, what: str, total: int) -> None:
        """So many gradings of this kind."""
        self._what, self._total, self._all = what, total, 0

    def done(self) -> None:
        """One more was graded."""
        self.graded += 1
        self._all += 1
        line = f"[{self._all:>{len(str(self._total))}}/{self._total}] {self._what}"
        if self._terminal:
            self._stream.write(f"\r\x1b[K{line[:_WIDTH]}" + ("\r\x1b[K" if self._all == self._total else ""))
        elif self._all % _EACH == 0 or self._all == self._total:
            self._stream.write(f"{line}\n")
        self._stream.flush()


def as_text(proof: GraderProof) -> str:
    """What was found, the survivors first."""
    lines: list[str] = []
    survivors = proof.of(SURVIVED)
    if survivors:
        lines += ["Mistakes that get full marks, with no reason given:", ""]
        for one in survivors:
            lines += [*_mutant(proof, one), ""]
    by_chance = proof.of(BY_CHANCE)
    if by_chance:
        lines += ["Mistakes that get full marks with some seeds and not with others:", ""]
        for one in by_chance:
            lines += [*_mutant(proof, one), ""]
    found = problems(proof)
    if found:
        for problem in found:
            lines += wrapped(f"✗ {problem}", following="    ", width=_WIDTH)
        lines.append("")
    return "\n".join([*lines, *_summary(proof)])


def about(proof: GraderProof, one: MutantOutcome) -> list[str]:
    """What of the task a mutant breaks, as far as anything tells: sentences, or titles of checks that prove none."""
    titles = {check.id: check.title for check in proof.checks}
    texts = {sentence.id: sentence.text for sentence in proof.exercise.sentences}
    if named := proof.sentences_about(one.mutant):
        return [f"{name}: {texts.get(name, '')}" for name in named]
    return [f"the check {name}: {titles.get(name, name)}" for name in proof.checks_about(one.mutant)] or [_UNKNOWN]


def _mutant(proof: GraderProof, one: MutantOutcome) -> Iterator[str]:
    yield f"{proof.solution.name}, line {one.mutant.line}: {one.mutant.operator}"
    yield from (f"    {line}" for line in one.mutant.diff)
    yield "  breaks perhaps"
    for text in about(proof, one):
        yield from wrapped(text, "    ", "        ", width=_WIDTH)


def problems(proof: GraderProof) -> list[str]:
    """All that does not hold beside the survivors."""
    return list(_problems(proof))


def _problems(proof: GraderProof) -> Iterator[str]:
    for one in proof.variants:
        shown = [verdict.shown for verdict in one.verdicts]
        if one.flaky:
            yield f"The verdict on {one.name} differs from one time to the next: {'; '.join(dict.fromkeys(shown))}."
        elif one.rejected:
            said = next(verdict.said for verdict in one.verdicts if not verdict.full_marks)
            yield f"This grader rejects a right program: {one.name} gets {shown[0]}. {said}"
    for one_mutant in proof.wrongly_declared:
        seen = " and ".join(one_mutant.seen_by)
        yield f"Declared as equivalent, but {seen} sees it: {one_mutant.mutant.key}. Take it out of the declarations."
    for entry in proof.unused:
        yield f"Declared as equivalent, but there is no such mutant any more: {entry}. Take it out, or adapt it."


def _summary(proof: GraderProof) -> Iterator[str]:
    counts = Counter(one.state for one in proof.mutants)
    graded = len(proof.mutants) - counts[NOT_GRADED]
    what = [f"{counts[SEEN]} seen", f"{counts[SURVIVED]} survived", f"{counts[EQUIVALENT]} declared as equivalent"]
    if counts[BY_CHANCE]:
        what.append(f"{counts[BY_CHANCE]} seen with some seeds only")
    yield f"{proof.exercise.id}: {graded} of {len(proof.mutants)} mistakes graded: {', '.join(what)}."
    unclear = [one for one in proof.mutants if one.state == NOT_GRADED and any(each.problem for each in one.verdicts)]
    if unclear:
        yield f"{len(unclear)} could not be graded; the first: {unclear[0].verdicts[-1].problem}"
    right = [one for one in proof.variants if one.verdicts]
    gradings = sum(len(one.verdicts) for one in right)
    yield f"{len(right)} right programs graded, {gradings} gradings."
    if proof.holds:
        found = "A sample was graded, and nothing was found." if proof.quick else "PROVEN."
    else:
        found = "NOT PROVEN."
    yield f"{found} (seed {proof.seed}, {proof.duration_s:.0f} s)"

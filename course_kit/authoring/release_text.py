"""What `course-kit release` says: how far it is, what the edition holds, what stayed out, and what must not go in."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, TextIO

from course_kit import environment
from course_kit.authoring.parts import LIST
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from course_kit.authoring.edition_plan import EditionPlan
    from course_kit.authoring.proof import EditionProof

_EACH = 25  # programs from one line of progress to the next, where lines cannot be written over
_NAMED = 10  # files that are named; of more, their folders with counts


class ProofProgress:
    """Shows how far the proof is: one line kept up to date on a terminal, some lines elsewhere."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._terminal = stream.isatty()
        self._done = self._total = 0

    def begin(self, programs: int) -> None:
        """See `proof.ProofWatcher`."""
        self._total = programs
        self._say(f"Grading {_count(programs, 'program')} found in the edition; this takes a minute or two.", keep=True)

    def done(self) -> None:
        """See `proof.ProofWatcher`."""
        self._done += 1
        if self._terminal or self._done % _EACH == 0:
            self._say(f"[{self._done:>{len(str(self._total))}}/{self._total}] graded", keep=not self._terminal)

    def end(self) -> None:
        """See `proof.ProofWatcher`."""
        if self._terminal:
            self._say("", keep=False)

    def _say(self, line: str, *, keep: bool) -> None:
        begin = "\r\x1b[K" if self._terminal else ""
        self._stream.write(f"{begin}{line}" + ("\n" if keep else ""))
        self._stream.flush()


def made(path: Path, planned: EditionPlan, proven: EditionProof) -> str:
    """What to say of an edition that was made."""
    return "\n".join([f"The student edition is in {path}.", *_lines(planned, proven)])


def _lines(planned: EditionPlan, proven: EditionProof) -> Iterator[str]:
    yield (
        f"It holds {_count(len(planned.files), 'file')} and {_count(len(planned.exercises), 'exercise')}: "
        f"{', '.join(planned.exercises) or 'none'}."
    )
    if planned.drills:
        yield f"For practice it holds {_count(len(planned.drills), 'drill')}: {', '.join(planned.drills)}."
    graded = f"{_count(proven.programs, 'program')} found in it {'was' if proven.programs == 1 else 'were'} graded"
    yield f"{graded} in {proven.duration_s:.0f} s: none scores more than its exercise's starter."
    yield f"Left out: {_by_folder(planned.instructors)}."
    yield from _of_exercises(planned)
    if planned.untracked:
        yield f"Left out, because git does not know them: {_named(planned.untracked)}. To put them in: git add FILE"
    if planned.undecided:
        yield (
            f"Left out, because they are on no list: {_named(planned.undecided)}. "
            f"To put them in, or to say that they stay out, name them in {_short(LIST)}."
        )
    if planned.changed:
        yield f"Differ from the last commit: {_named(planned.changed)}."
    if planned.git:
        yield f"Git could not be asked ({planned.git}): all files on the list went in, and no changes are known."


def _of_exercises(planned: EditionPlan) -> Iterator[str]:
    if planned.unwanted:
        yield f"Left out, as you asked: {', '.join(planned.unwanted)}."
    for name, folder in planned.added.items():
        yield f"Put in from another folder: {name} ({folder})."


def answers_found(proven: EditionProof) -> str:
    """What to say of an edition that would hold answers."""
    rows = [
        (
            one.candidate.file,
            one.candidate.place,
            one.candidate.exercise,
            f"{one.score:g} of {one.points:g}",
            f"{one.starter:g}",
        )
        for one in sorted(proven.findings, key=lambda one: (one.candidate.file, one.candidate.place))
    ]
    table = _table([("file", "where", "exercise", "scores", "starter"), *rows])
    many = _count(len(rows), "program")
    return (
        f"no student edition was made: {many} in it would score more than a starter may.\n\n{table}\n\n"
        f"Take them out, or name their files among the instructor's in {_short(LIST)}; then run this again."
    )


def _table(rows: Sequence[Sequence[str]]) -> str:
    rows = [[one_line(cell) for cell in row] for row in rows]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(f"{cell:<{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    )


def _count(number: int, thing: str) -> str:
    return f"{number} {thing}" if number == 1 else f"{number} {thing}s"


def _named(names: Sequence[str]) -> str:
    """Files by name, or when there are many by folder."""
    return ", ".join(map(one_line, names)) if len(names) <= _NAMED else _by_folder(names)


def _by_folder(names: Iterable[str]) -> str:
    """Files counted by folder: `solutions (4), tests (210), README.md`."""
    counts = Counter(_folder(name) for name in names)
    shown = [
        f"{one_line(name)} ({count})" if name.endswith("/") else one_line(name)
        for name, count in sorted(counts.items())
    ]
    return ", ".join(shown) or "nothing"


def _folder(name: str) -> str:
    """The folder to count a file in; its own name at the top. The kit is shown one level deeper."""
    parts = name.split("/")
    depth = 2 if parts[0] == "course_kit" else 1
    return name if len(parts) <= depth else "/".join(parts[:depth]) + "/"


def _short(path: Path) -> str:
    root = environment.checkout()
    return str(path.relative_to(root)) if root is not None and path.is_relative_to(root) else str(path)

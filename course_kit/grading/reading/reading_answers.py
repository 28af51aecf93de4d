"""What the reader tells of a submission, in the words of those who trust it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.grading.model.submission import Facts, Submission, SyntaxFault
from course_kit.reader.text import kind_of_file

if TYPE_CHECKING:
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.model.submission import Copy


@dataclass(frozen=True)
class Glance:
    """What a file that may be a submission looks like.

    Attributes:
        asked_for: whether it holds what the exercise asks for.
        identity: of its program; equal for programs that differ in comments and blanks alone, empty when there is none.
        imports: names of modules that it imports.
    """

    asked_for: bool = False
    identity: str = ""
    imports: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Fingerprints:
    """What two programs are compared by, see `course_kit.reader.fingerprints`; nothing where there is no program.

    Attributes:
        identity: equal for programs that differ in comments and blanks alone.
        prints: hashes of short runs of its tokens.
    """

    identity: str = ""
    prints: frozenset[int] = frozenset()


@dataclass(frozen=True)
class Look:
    """What a file that may be a submission looks like, and what was read of it at once, where it is asked for.

    Attributes:
        glance: what it looks like.
        program: the program; None where the file is not asked for, or holds none that can be read.
        fingerprints: of the program.
    """

    glance: Glance
    program: Submission | None = None
    fingerprints: Fingerprints = Fingerprints()


def look(copy: Copy, told: Record) -> Look:
    """Of an answer to a glance."""
    glance = Glance(bool(told["found"]), str(told["identity"]), frozenset(map(str, told["imports"])))
    if "source" not in told:
        return Look(glance)
    return Look(glance, submission(copy, told), Fingerprints(glance.identity, frozenset(map(int, told["prints"]))))


def submission(copy: Copy, told: Record) -> Submission:
    """Of an answer that has a program."""
    fault, facts = told["fault"], told["facts"]
    return Submission(
        name=copy.name,
        program=_program_name(copy.name),
        source=told["source"],
        places=tuple((int(cell), int(lines)) for cell, lines in told["places"]),
        fault=SyntaxFault(*fault) if fault else None,
        facts=_facts(facts) if facts else Facts(),
        literal=told["literal"],
        twice=str(told["twice"]),
    )


def _facts(told: Record) -> Facts:
    """What the reader's child says of a text; it has read what a stranger wrote."""
    functions = tuple((int(first), int(last), bool(waits)) for first, last, waits in told["functions"])
    signs = {name: bool(told[name]) for name in ("awaits", "floor_divides", "loops", "waits")}
    return Facts(**signs, functions=functions, future=int(told["future"]))


def _program_name(name: str) -> str:
    """A name to run under, which stands in tracebacks as it is: `a b.py` for `a b.ipynb`."""
    stem = name
    while kind_of_file(stem):  # `a.py` of `a.py.txt`, then `a`
        stem = stem.rpartition(".")[0]
    plain = "".join(one if one.isprintable() and one not in '"\\/' else "_" for one in stem)
    return f"{plain}.py"

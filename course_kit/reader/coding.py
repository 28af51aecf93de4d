"""The line that names a program's encoding (PEP 263), read as Python reads it."""

from __future__ import annotations

import codecs
import re

_CODING = re.compile(r"^([ \t\f]*#.*?coding[:=][ \t]*)([-\w.]+)")
_NO_STATEMENT = re.compile(r"^[ \t\f]*(?:#.*)?\r?$")
_LINES = 2  # the first ones, in which it may stand
_BEGIN = 4096  # bytes, in which these end


class CodingError(ValueError):
    """Python would not read it; the text says why, and what to do."""


def decode(program: bytes) -> str:
    """A program's text."""
    text = program.removeprefix(codecs.BOM_UTF8)
    begin = text[:_BEGIN].decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    place = _place(begin.split("\n"))
    named = _CODING.match(begin.split("\n")[place]) if place is not None else None
    coding = named[2] if named else "utf-8"
    try:
        if len(text) < len(program) and codecs.lookup(coding).name != "utf-8":
            raise CodingError(f"begins as UTF-8 does and names the encoding {coding}. Delete that line.")
        return text.decode(coding)
    except LookupError:
        raise CodingError(f"names the encoding {coding}, which Python does not know. Delete that line.") from None
    except UnicodeError as problem:
        byte = f" (byte {problem.start + 1})" if isinstance(problem, UnicodeDecodeError) else ""
        advice = "Save it with the encoding UTF-8."
        if named:
            raise CodingError(f"names the encoding {coding} and is not written in it{byte}. {advice}") from None
        raise CodingError(f"is not UTF-8 text{byte}. {advice}") from None


def as_utf8(source: str) -> str:
    """A program, as it will be written: with UTF-8 in place of the encoding that its coding line names."""
    lines = source.split("\n", _LINES)
    place = _place(lines)
    if place is not None:
        lines[place] = _CODING.sub(r"\1utf-8", lines[place])
    return "\n".join(lines)


def _place(lines: list[str]) -> int | None:
    """Which of the first lines names an encoding; what stands below a statement does not."""
    for place, line in enumerate(lines[:_LINES]):
        if _CODING.match(line):
            return place
        if not _NO_STATEMENT.match(line):
            return None
    return None

"""A submission's text, out of a .py or .ipynb file: bytes from a stranger, read without ever failing loudly."""

from __future__ import annotations

import ast
import json
import os
import re
import stat
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

LARGEST = 1024 * 1024  # bytes
_PARSING = threading.Lock()  # CPython 3.11 counts the depth of a tree for all threads together and then refuses it
_MAGIC = re.compile(r"^%%submission\s+(?P<exercise>\S+)\s*$")


class UnreadableError(ValueError):
    """A submission that cannot be read; the text says why and what to do."""


@dataclass(frozen=True)
class SyntaxFault:
    """Where Python stopped reading: the line's number and text, and what it says about it."""

    line: int
    text: str
    problem: str


@dataclass(frozen=True)
class Submission:
    """The text to run.

    Attributes:
        name: the file's name, for reports.
        program: the name it runs under, ends in .py.
        source: Python text with plain line ends.
        places: for each line of a notebook's source its cell and the line there, both from 1; empty for a .py file.
    """

    name: str
    program: str
    source: str
    places: tuple[tuple[int, int], ...] = ()

    def syntax_fault(self) -> SyntaxFault | None:
        """Where the text is not Python, or None when it is."""
        try:
            with _PARSING:
                ast.parse(self.source, self.program)
        except SyntaxError as fault:
            return SyntaxFault(fault.lineno or 0, (fault.text or "").strip(), fault.msg)
        except (ValueError, RecursionError, MemoryError) as fault:
            return SyntaxFault(0, "", f"Python cannot read it ({fault or type(fault).__name__})")
        return None

    def where(self, line: int) -> str:
        """`line 12`, for notebooks `cell 3, line 2`."""
        if 0 < line <= len(self.places):
            cell, inner = self.places[line - 1]
            return f"cell {cell}, line {inner}"
        return f"line {line}"


def read(path: Path, exercise_id: str) -> Submission:
    """Read a submission.

    Raises:
        UnreadableError: it cannot be read, is empty, too large, not UTF-8 or holds no cell for this exercise.
    """
    text = _decode(_read_bytes(path), path)
    if path.suffix == ".ipynb":
        return _from_notebook(text, path, exercise_id)
    if path.suffix != ".py":
        raise UnreadableError(f"{path.name} is no .py and no .ipynb file. Hand in one of these.")
    source = _plain_lines(text)
    if not source.strip():
        raise UnreadableError(f"{path.name} is empty.")
    if "\0" in source:
        raise UnreadableError(f"{path.name} is not Python: it contains null bytes.")
    return Submission(readable(path.name), readable(path.name), source)


def readable(name: str) -> str:
    """A file's name or path as text, whatever bytes it is of and whatever the locale made of them.

    A program with a name that is no text does not start: rclpy refuses it among the arguments.
    """
    try:
        return os.fsencode(name).decode(errors="replace")
    except UnicodeEncodeError:  # typed by somebody whose locale has no such letters
        return name.encode(errors="replace").decode()


def _read_bytes(path: Path) -> bytes:
    try:
        _require_a_file(path)
        with path.open("rb") as file:
            data = file.read(LARGEST + 1)
    except UnreadableError:
        raise
    except FileNotFoundError:
        raise UnreadableError(f"There is no file {path}.") from None
    except (OSError, RuntimeError, ValueError) as problem:  # a loop of links, no permission, a null byte in the name
        raise UnreadableError(f"{path.name} cannot be read: {getattr(problem, 'strerror', None) or problem}.") from None
    if len(data) > LARGEST:
        raise UnreadableError(f"{path.name} is larger than {LARGEST // 1024} kB. Hand in the program alone.")
    return data


def _require_a_file(path: Path) -> None:
    if path.is_symlink() and path.resolve().parent != path.parent.resolve():
        raise UnreadableError(f"{path.name} is a link to a file outside its folder. Hand in the file itself.")
    kind = path.stat()
    if stat.S_ISDIR(kind.st_mode):
        raise UnreadableError(f"{path.name or path} is a folder. Name the .py or .ipynb file in it.")
    if not stat.S_ISREG(kind.st_mode):
        raise UnreadableError(f"{path.name} is no ordinary file. Hand in a .py or .ipynb file.")


def _decode(data: bytes, path: Path) -> str:
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as problem:
        raise UnreadableError(
            f"{path.name} is not UTF-8 text (byte {problem.start + 1}). Save it with the encoding UTF-8."
        ) from None


def _plain_lines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _from_notebook(text: str, path: Path, exercise_id: str) -> Submission:
    try:
        cells = [_cell_text(cell) for cell in json.loads(text)["cells"]]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise UnreadableError(f"{path.name} is no Jupyter notebook. Save it again in JupyterLab.") from None
    lines, places, others = [], [], []
    for number, cell in enumerate(cells, start=1):
        first, *rest = _plain_lines(cell).split("\n")
        if not (match := _MAGIC.match(first)):
            continue
        if match["exercise"] != exercise_id:
            others.append(match["exercise"])
            continue
        lines += rest
        places += [(number, inner) for inner in range(2, len(rest) + 2)]
    if not "".join(lines).strip():
        found = f" It has cells for: {', '.join(sorted(set(others)))}." if others else ""
        raise UnreadableError(
            f"{path.name} has no code cell that begins with the line '%%submission {exercise_id}'.{found}"
        )
    return Submission(readable(path.name), f"{readable(path.stem)}.py", "\n".join(lines) + "\n", tuple(places))


def _cell_text(cell: Any) -> str:
    """The text of a code cell; nothing for other cells."""
    if cell["cell_type"] != "code":
        return ""
    source = cell["source"]  # a list of lines in a file, a string in other writers' files
    return source if isinstance(source, str) else "".join(source)

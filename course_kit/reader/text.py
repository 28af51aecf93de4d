"""A submission's program, out of the bytes of a .py or .ipynb file."""

from __future__ import annotations

import ast
import codecs
import json
import re
from collections import Counter

from course_kit.reader import python

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import BinaryIO

LARGEST = 1 << 20  # bytes of a program
PROGRAM, NOTEBOOK = ".py", ".ipynb"
_ADDED = (".txt", ".json")  # to a name, by a browser, a mail program or an editor that does not know the ending
_AS_A_PROGRAM = re.compile(r"%%ros_script\b")  # may follow: the cell is also run in the notebook, as a program
_MAGIC = re.compile(r"%%submission[^\S\n]+(?P<exercise>\S+)(?:[^\S\n]+(?P<file>\S+))?[^\S\n]*\Z")
_NO_NOTEBOOK = (ValueError, TypeError, KeyError, AttributeError, RecursionError)
_EXECUTED = re.compile(rb"[0-9]{1,6}")
_NUMBER = re.compile(r"# In\s*\[(\d{1,6})\]:")
# The line that names a program's encoding (PEP 263) is one of its first two, above all statements.
_CODING = re.compile(r"((?:[ \t\f]*(?:#[^\n]*)?\n)??[ \t\f]*#[^\n]*?coding[:=][ \t]*)([-\w.]+)")
_BEGIN = 4096  # bytes, in which these end
_FEW, _LONGEST_NAME = 10, 40  # of other exercises that are named


def kind_of_file(name: str) -> str:
    """What a file is by its name, PROGRAM or NOTEBOOK, and nothing when it is neither."""
    plain = name.lower()
    for added in _ADDED:
        plain = plain.removesuffix(added)
    return next((ending for ending in (PROGRAM, NOTEBOOK) if plain.endswith(ending)), "")


class UnreadableTextError(ValueError):
    """There is no program in it; the text says why and what to do."""


def read_program(name: str, file: BinaryIO, exercise: str) -> tuple[str, list[tuple[str, int]]]:
    """The program, and of a notebook for each cell it was joined from what to call it and how many lines it gave."""
    text = decode_text(name, file.read())
    places: list[tuple[str, int]] = []
    if kind_of_file(name) == NOTEBOOK:
        source, places = join_cells(name, code_cells(name, text), exercise)
    else:
        source = read_text(name, text)
        if cells := _exported_cells(source):
            source, places = join_cells(name, cells, exercise)
    if "\0" in source:
        raise UnreadableTextError(f"{name} is not Python: it contains null bytes.")
    return source, places


def read_text(name: str, text: str) -> str:
    """A program's text as it will be written."""
    source = as_utf8(_plain_lines(text))
    if not source.strip():
        raise UnreadableTextError(f"{name} is empty.")
    return source


def decode_text(name: str, data: bytes) -> str:
    """A file's text; a program's as Python reads it."""
    text = data.removeprefix(codecs.BOM_UTF8)
    begin = _plain_lines(text[:_BEGIN].decode("latin-1"))
    named = _CODING.match(begin) if kind_of_file(name) == PROGRAM else None
    coding = named[2] if named else "utf-8"
    try:
        if len(text) < len(data) and codecs.lookup(coding).name != "utf-8":
            problem = f"begins as UTF-8 does and names the encoding {coding}. Delete that line."
        else:
            return text.decode(coding)
    except LookupError:
        problem = f"names the encoding {coding}, which Python does not know. Delete that line."
    except UnicodeError as error:
        byte = f" (byte {error.start + 1})" if isinstance(error, UnicodeDecodeError) else ""
        wrong = f"names the encoding {coding} and is not written in it" if named else "is not UTF-8 text"
        problem = f"{wrong}{byte}. Save it with the encoding UTF-8."
    raise UnreadableTextError(f"{name} {problem}")


def as_utf8(source: str) -> str:
    """A program, as it will be written: with UTF-8 in place of the encoding that its coding line names."""
    named = _CODING.match(source)
    return source if named is None else f"{named[1]}utf-8{source[named.end() :]}"


def join_cells(
    name: str, cells: Iterable[tuple[str, str]], exercise: str, file: str = ""
) -> tuple[str, list[tuple[str, int]]]:
    """The program of the cells for an exercise, or for one file of it."""
    parts: list[list[str]] = []
    places: list[tuple[str, int]] = []
    others: set[str] = set()
    for label, cell in cells:
        rest = _plain_lines(cell).split("\n")
        # The place of the first line that is neither blank nor a comment, else of the first line.
        first = next(
            (place for place, line in enumerate(rest) if line.strip() and not line.lstrip().startswith("#")), 0
        )
        indentation = rest[first][: len(rest[first]) - len(rest[first].lstrip(" \t"))]  # IPython takes it away, too
        rest = [line.removeprefix(indentation) for line in rest]
        if not (match := _MAGIC.match(rest.pop(first))):
            continue
        if match["exercise"] != exercise:
            others.add(match["exercise"])
            continue
        if (match["file"] or "") != file:
            continue
        if first < len(rest) and _AS_A_PROGRAM.match(rest[first]):
            rest[first] = ""  # empty, so that the lines below keep their numbers
        parts.append(rest)
        places.append((label, len(rest)))
    lines = [line for part in _started_once(parts) for line in part]
    source = as_utf8("\n".join(lines) + "\n")
    if not source.strip():
        named = ", ".join(other[:_LONGEST_NAME] for other in sorted(others)[:_FEW])
        found = f" It has cells for: {named}." if named else ""
        raise UnreadableTextError(
            f"{name} has no code cell that begins with the line '%%submission {exercise}{file and f' {file}'}'.{found}"
        )
    try:
        size = len(source.encode())
    except UnicodeEncodeError as problem:
        raise UnreadableTextError(
            f"{name} is not Python: its program contains half of a character "
            f"(U+{ord(source[problem.start]):04X}), which no text can hold."
        ) from None
    if size > LARGEST:
        raise UnreadableTextError(f"{name} holds more than {LARGEST // 1024} kB of code. Hand in only the program.")
    return source, places


def _started_once(parts: list[list[str]]) -> list[list[str]]:
    """Cells as a notebook runs them: all of them, and what starts a program, such as its `main`, at the end."""
    if len(parts) < 2:  # noqa: PLR2004 - several
        return parts
    last: list[str] = []
    for part in parts:
        starts = python.find_starts("\n".join(part))
        if starts:
            last = [line for begin, end in starts for line in part[begin:end]]
        for begin, end in starts:
            part[begin:end] = [""] * (end - begin)
    return [*parts, last]


def code_cells(name: str, text: str) -> list[tuple[str, str]]:
    """What to call each code cell, `In[17]` if only this one has that number, else `cell 3`; and its text."""
    try:
        # Numbers are bytes: they may have a million digits, and are no text of a cell.
        cells = json.loads(text, parse_int=str.encode, parse_float=str.encode)["cells"]
        runs = Counter(cell.get("execution_count") for cell in cells)
        once = {run: f"In[{run.decode()}]" for run in runs if runs[run] == 1 and _EXECUTED.fullmatch(run or b"")}
        return [
            (once.get(cell.get("execution_count"), f"cell {place}"), "".join(cell["source"]))
            for place, cell in enumerate(cells, 1)
            if cell["cell_type"] == "code"
        ]
    except _NO_NOTEBOOK:
        raise UnreadableTextError(f"{name} is not a Jupyter notebook. Save it again in JupyterLab.") from None


def _exported_cells(source: str) -> list[tuple[str, str]]:
    """`In[3]` and text of each cell with a `%%submission` of a notebook that Jupyter has exported as a script."""
    if "run_cell_magic" not in source:
        return []
    numbers = [1]  # by line, of the comment `# In[3]:` above it
    for line in source.split("\n"):
        match = _NUMBER.match(line)
        numbers.append(int(match[1]) if match else numbers[-1])
    _, tree = python.parse_program(source)
    found = []
    for node in tree.body if tree else ():
        match node:
            case ast.Expr(
                ast.Call(
                    ast.Attribute(attr="run_cell_magic"),
                    [ast.Constant("submission"), ast.Constant(str(line)), ast.Constant(str(cell))],
                )
            ):
                found.append((f"In[{numbers[node.lineno]}]", f"%%submission {line}\n{cell}"))
    return found


def _plain_lines(text: str) -> str:
    return text.replace("\r\n", "\n").replace("\r", "\n")

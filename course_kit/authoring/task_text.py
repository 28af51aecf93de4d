"""Puts the sentences of an exercise into its notebook and its starter.

They are written once, in exercise.toml. In a notebook's cell and in the starter's docstring they stand where the lines
are that begin with "- " or "|"; whatever is written before the first and after the last of those stays as it is.
"""

from __future__ import annotations

import itertools
import json
import textwrap
from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.grading.model.exercise import Exercise, Sentence

_WIDTH = 118  # columns of a starter's docstring
_PLACES = ("- ", "|")
_QUOTES = '"""'


def format_sentences(sentences: Sequence[Sentence], *, width: int = 0) -> str:
    """Sentences as a list in Markdown, with tables where there are rows."""
    parts = [
        _table(group) if rows else "\n".join(_items(group, width))
        for rows, group in _group_rows(sentences)  # a list is a group, and so is each table
    ]
    return "\n\n".join(parts)


def group_by_cell(sentences: Sequence[Sentence]) -> dict[str, list[Sentence]]:
    """The sentences by the notebook's cell in which they stand."""
    cells: dict[str, list[Sentence]] = {}
    cell = ""
    for sentence in sentences:
        cell = sentence.cell or cell
        cells.setdefault(cell, []).append(sentence)
    return cells


def sentences_of(exercise: Exercise, file: str) -> Sequence[Sentence]:
    """What stands in a starter: of several each has its own cell, and the launch file all that no program has."""
    if not exercise.files:
        return exercise.sentences
    cells, own = group_by_cell(exercise.sentences), {name.partition(".")[0] for name in exercise.files}
    if file != exercise.launch_file:
        return cells[file.partition(".")[0]]
    own.remove(file.partition(".")[0])
    return [sentence for cell, sentences in cells.items() if cell not in own for sentence in sentences]


def fill_starter(text: str, exercise: Exercise, file: str = "") -> str:
    """A starter's program with the sentences of its exercise in its docstring."""
    name = file or exercise.starter
    before, *rest = text.split(_QUOTES, 2)
    if len(rest) != 2 or before.strip():  # noqa: PLR2004 - the docstring and what follows
        raise GradingError(f"{name} does not begin with a docstring, into which its task belongs.")
    block = format_sentences(sentences_of(exercise, name), width=_WIDTH)
    docstring = replace_block(rest[0], block, f"the docstring of {name}")
    return _QUOTES.join([before, docstring, rest[1]])


def fill_notebook(text: str, exercise: Exercise) -> str:
    """A notebook's file with the sentences of its exercise in its cells."""
    notebook = json.loads(text)
    for name, sentences in group_by_cell(exercise.sentences).items():
        cell = next((cell for cell in notebook["cells"] if cell.get("id") == name), None)
        if cell is None:
            raise GradingError(f"{exercise.notebook} has no cell with the id '{name}', where a sentence is to stand.")
        where = f"the cell '{name}' of {exercise.notebook}"
        source = replace_block("".join(cell["source"]), format_sentences(sentences), where)
        cell["source"] = source.splitlines(keepends=True)
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


def replace_block(text: str, block: str, where: str) -> str:
    """A text in which `block` stands where lists and tables were."""
    lines = text.splitlines()
    marked = [number for number, line in enumerate(lines) if line.startswith(_PLACES)]
    if not marked:
        raise GradingError(f"{where} has no line that begins with '- ', which is where the sentences go.")
    last = marked[-1]
    while last + 1 < len(lines) and lines[last + 1].startswith("  "):
        last += 1
    end = "\n" if text.endswith("\n") else ""
    return "\n".join([*lines[: marked[0]], block, *lines[last + 1 :]]) + end


def _group_rows(sentences: Sequence[Sentence]) -> Iterable[tuple[bool, list[Sentence]]]:
    table = 0

    def kind(sentence: Sentence) -> tuple[bool, int]:
        nonlocal table
        table += sentence.is_row and bool(sentence.heading)
        return sentence.is_row, table if sentence.is_row else 0

    for (rows, _), group in itertools.groupby(sentences, kind):
        yield rows, list(group)


def _items(sentences: Iterable[Sentence], width: int) -> Iterable[str]:
    items: list[list[str]] = []
    for sentence in sentences:
        if sentence.heading or not items:
            bold = sentence.heading if width else f"**{sentence.heading}**"
            items.append([bold] if sentence.heading else [])
        items[-1].append(sentence.text)
    for words in items:
        text = "- " + " ".join(words)
        if width:
            text = textwrap.fill(text, width, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
        yield text


def _table(rows: Sequence[Sentence]) -> str:
    header = [rows[0].heading] if rows[0].heading else []
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in (*header, *(row.text for row in rows))]
    if odd := [line for line in cells if len(line) != len(cells[0])]:
        raise GradingError(f"The row '| {' | '.join(odd[0])} |' does not have {len(cells[0])} cells as its table has.")
    widths = [max(len(cell) for cell in column) for column in zip(*cells, strict=True)]
    lines = ["| " + " | ".join(map(str.ljust, line, widths)) + " |" for line in cells]
    if header:
        lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)

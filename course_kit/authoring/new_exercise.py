"""`course-kit new exercise`: the folder of an exercise that works at once, for an author to change.

The texts that learners read are written once: the sentences of the task in exercise.toml, the program to begin with in
the starter. The starter's docstring and the notebook are made from them, and made anew by `refresh`. The sentences
stand where the lines are that begin with "- " or "|"; what is before the first and after the last of those stays.
"""

from __future__ import annotations

import itertools
import json
import keyword
import os
import re
import tempfile
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.environment import write_atomically
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, Sentence, read_exercise
from course_kit.grading.model.submission import LAUNCH_FILE
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence


KINDS = ("service", "action", "parameters", "topic")
_TEMPLATES = Path(__file__).with_name("templates") / "new_exercise"
_ENDING = ".in"  # keeps linters and pytest from taking a template for something to run
_NAME = re.compile(r"[a-z][a-z0-9_]*\Z")
_LONGEST = 40
_IN_PLACE_OF_NAME, _IN_PLACE_OF_CLASS = "@ID@", "@CLASS@"

_TITLE, _ANSWER = "title", "answer"  # the cells that are made anew; that of the task is filled by `fill_notebook`
_QUOTES = '"""'
_WIDTH = 118  # columns of a starter's docstring
_PLACES = ("- ", "|")
_MAIN = "\ndef main("
METADATA = {
    "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
_YOURS = (
    "## Your node\n\nThe first line marks the cell as your answer: leave it where it is. You may use several such "
    "cells; they are joined in order. Running the cell defines the class, nothing more."
)
_TRY = "## Try it\n\nStart your node. Run this cell again after each change: the new node replaces the old one."
_GRADING = (
    "## Grade it\n\nThis grades what you last ran in the cell above. The grader starts your node in a separate "
    "process, on a separate graph: without a `main` that is called it makes `{class_name}()`, without arguments, and "
    "spins it on a `MultiThreadedExecutor`. Stuck? `%hint {id}` in a separate cell gives one more hint."
)


def create_exercise(name: str, kind: str, folder: Path) -> Exercise:
    """Make a new exercise."""
    _require_usable(name)
    target = folder.absolute() / name
    if os.path.lexists(target):
        raise GradingError(f"{target} exists already. Choose another name, or another folder with --in.")
    if places := exercise_folders.find_exercises().folders.get(name):
        raise GradingError(f"There is an exercise '{name}' already, in {places[0]}. Choose another name.")
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=folder) as workshop:
        made = Path(workshop) / name
        for path, text in _files(name, kind):
            (made / path).parent.mkdir(parents=True, exist_ok=True)
            (made / path).write_text(text, encoding="utf-8")
        exercise = read_exercise(made)
        (made / exercise.notebook).write_text(_new_notebook(exercise), encoding="utf-8")
        refresh_exercise(exercise)
        made.rename(target)
    return read_exercise(target)


def refresh_exercise(exercise: Exercise) -> list[Path]:
    """Write the sentences of an exercise anew into its starter and its notebook; returns what has changed."""
    programs = [exercise.folder / name for name in exercise.files or (exercise.starter,) if name.endswith(".py")]
    notebook = exercise.folder / exercise.notebook
    before = {path: path.read_text(encoding="utf-8") for path in (*programs, notebook)}
    after = {path: fill_starter(before[path], exercise, path.name) for path in programs}
    cells = before[notebook]
    if exercise_folders.is_added(exercise.folder) and not exercise.files:
        (program,) = programs
        after[program] = re.sub(r'\A\s*"""[^\n]*', lambda _: f'"""{exercise.title}.', after[program])
        cells = _renewed_notebook(cells, exercise, after[program])
    after[notebook] = fill_notebook(cells, exercise)
    changed = [path for path in after if after[path].split() != before[path].split()]  # lines may be wrapped elsewhere
    for path in changed:
        write_atomically(path, after[path])
    return changed


def _require_usable(name: str) -> None:
    if _NAME.match(name) and len(name) <= _LONGEST and not keyword.iskeyword(name):
        return
    raise GradingError(
        f"'{name}' cannot be the name of an exercise. Write up to {_LONGEST} small letters, digits and _, a letter "
        "first, such as my_exercise."
    )


def _files(name: str, kind: str) -> Iterator[tuple[Path, str]]:
    """The files of a new exercise and what they hold, but for its notebook."""
    folder = _TEMPLATES / kind
    names = {"starter.py": f"{name}.py", "solution.py": f"solution/{name}.py"}
    class_name = "".join(part.capitalize() for part in name.split("_"))
    for path in sorted(folder.rglob(f"*{_ENDING}")):
        inside = path.relative_to(folder).as_posix().removesuffix(_ENDING)
        text = path.read_text(encoding="utf-8")
        filled_in = text.replace(_IN_PLACE_OF_NAME, name).replace(_IN_PLACE_OF_CLASS, class_name)
        yield Path(names.get(inside, inside)), filled_in


def _new_notebook(exercise: Exercise) -> str:
    """The notebook of a new exercise; the sentences of its task and its starter are not in it yet."""
    cells = [
        _cell(_TITLE, "markdown", ""),
        _cell("task", "markdown", "## The task\n\n- "),
        _cell("load", "code", "%load_ext course_kit"),
        _cell("yours", "markdown", _YOURS),
        _cell(_ANSWER, "code", ""),
        _cell("try", "markdown", _TRY),
        _cell("start", "code", f"from course_kit import lab\n\nlab.start({exercise.class_name})"),
        _cell("grading", "markdown", _GRADING.format(class_name=exercise.class_name, id=exercise.id)),
        _cell("grade", "code", f"%grade {exercise.id}"),
    ]
    return _as_text({"cells": cells, "metadata": METADATA, "nbformat": 4, "nbformat_minor": 5})


def _renewed_notebook(text: str, exercise: Exercise, starter: str) -> str:
    """A notebook with the title, the points and the starter of its exercise as they are now."""
    try:
        notebook = json.loads(text)
        by_id = {cell.get("id"): cell for cell in notebook["cells"]}
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        raise GradingError(f"{exercise.folder / exercise.notebook} is not a notebook: {problem}.") from None
    title = f"# {exercise.title}\n\n{in_points(exercise.points)}, {exercise.pass_mark:g} to pass."
    for name, source in ((_TITLE, title), (_ANSWER, f"%%submission {exercise.id}\n{_class_of(starter)}")):
        if name not in by_id:
            raise GradingError(f"{exercise.folder / exercise.notebook} has no cell with the id '{name}'. Put it back.")
        by_id[name]["source"] = source.splitlines(keepends=True)
    return _as_text(notebook)


def _class_of(starter: str) -> str:
    """A starter without its docstring, which is the task, and without its `main`, which the lab stands for."""
    parts = starter.split(_QUOTES, 2)
    program = parts[2] if not parts[0].strip() and len(parts) > 2 else starter  # noqa: PLR2004 - what follows it
    return program.partition(_MAIN)[0].strip()


def _cell(name: str, kind: str, source: str) -> dict[str, Any]:
    more: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": name, "metadata": {}, **more, "source": source.splitlines(keepends=True)}


def _as_text(notebook: dict[str, Any]) -> str:
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"


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
    if not file.endswith(LAUNCH_FILE):
        return cells[file.partition(".")[0]]
    own.remove(file.partition(".")[0])
    return [sentence for cell, sentences in cells.items() if cell not in own for sentence in sentences]


def fill_starter(text: str, exercise: Exercise, name: str) -> str:
    """A starter's program with the sentences of its exercise in its docstring."""
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
        is_row = sentence.text.startswith("|")
        table += is_row and bool(sentence.heading)
        return is_row, table if is_row else 0

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

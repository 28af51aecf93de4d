"""The notebook of an exercise, made from its exercise.toml and its starter; what its author adds stays in it."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from course_kit.grading.errors import GradingError
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from course_kit.grading.exercise import Exercise

_TITLE, _ANSWER = "title", "answer"  # the cells that are made anew; that of the task is filled by `task_text`
_QUOTES = '"""'
_MAIN = "\ndef main("
_METADATA = {
    "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
    "language_info": {"name": "python"},
}
_YOURS = (
    "## Your node\n\nThe first line marks the cell as your answer: leave it where it is. You may use several such "
    "cells; they are joined in order. Running the cell defines the class, nothing more."
)
_TRY = "## Try it\n\nStart your node. Run this cell again after each change: the new node replaces the old one."
_GRADING = (
    "## Grade it\n\nWhat you last ran in the cell above is graded. The grader starts your node in a process of its "
    "own, on a graph of its own: without a `main` that is called it makes `{class_name}()`, without arguments, and "
    "spins it on a `MultiThreadedExecutor`. Stuck? `%hint {id}` in a cell of its own gives one hint more."
)


def new(task: Exercise) -> str:
    """The notebook of a new exercise; the sentences of its task and its starter are not in it yet."""
    cells = [
        _cell(_TITLE, "markdown", ""),
        _cell("task", "markdown", "## The task\n\n- "),
        _cell("load", "code", "%load_ext course_kit"),
        _cell("yours", "markdown", _YOURS),
        _cell(_ANSWER, "code", ""),
        _cell("try", "markdown", _TRY),
        _cell("start", "code", f"from course_kit import lab\n\nlab.start({task.class_name})"),
        _cell("grading", "markdown", _GRADING.format(class_name=task.class_name, id=task.id)),
        _cell("grade", "code", f"%grade {task.id}"),
    ]
    return _text({"cells": cells, "metadata": _METADATA, "nbformat": 4, "nbformat_minor": 5})


def renewed(text: str, task: Exercise, starter: str) -> str:
    """A notebook with the title, the points and the starter of its exercise as they are now."""
    try:
        notebook = json.loads(text)
        by_id = {cell.get("id"): cell for cell in notebook["cells"]}
    except (ValueError, KeyError, TypeError, AttributeError) as problem:
        raise GradingError(f"{task.folder / task.notebook} is not a notebook: {problem}.") from None
    title = f"# {task.title}\n\n{in_points(task.points)}, {task.pass_mark:g} to pass."
    for name, source in ((_TITLE, title), (_ANSWER, f"%%submission {task.id}\n{_class_of(starter)}")):
        if name not in by_id:
            raise GradingError(f"{task.folder / task.notebook} has no cell with the id '{name}'. Put it back.")
        by_id[name]["source"] = source.splitlines(keepends=True)
    return _text(notebook)


def _class_of(starter: str) -> str:
    """A starter without its docstring, which is the task, and without its `main`, which the lab stands for."""
    parts = starter.split(_QUOTES, 2)
    program = parts[2] if not parts[0].strip() and len(parts) > 2 else starter  # noqa: PLR2004 - what follows it
    return program.partition(_MAIN)[0].strip()


def _cell(name: str, kind: str, source: str) -> dict[str, Any]:
    more: dict[str, Any] = {"execution_count": None, "outputs": []} if kind == "code" else {}
    return {"cell_type": kind, "id": name, "metadata": {}, **more, "source": source.splitlines(keepends=True)}


def _text(notebook: dict[str, Any]) -> str:
    return json.dumps(notebook, indent=1, ensure_ascii=False) + "\n"

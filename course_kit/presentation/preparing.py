"""Fills the folder of a presentation: the copies, JupyterLab's settings, and the page of the speaker's window.

A copy is made from the one file that also holds the speaker's notes. Left out are notes (`slideshow.slide_type`
"notes") and cells tagged `instructor`, `offstage` or `answer`. Where the metadata of an answer says
`course_kit.repairs` with the id of a failing cell, a button puts it in that cell's place.
"""

from __future__ import annotations

import json
import shutil
from contextlib import nullcontext, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import nbformat

from course_kit.authoring.edition_plan import ANSWER, INSTRUCTOR
from course_kit.environment import PACKAGE
from course_kit.grading.errors import GradingError
from course_kit.interfaces.hints import nearest_name
from course_kit.learner import workspace
from course_kit.text import templates

LESSONS = "notebooks"
DEMOS = f"{LESSONS}/demos"
OFFSTAGE = "offstage"  # a cell with this tag speaks to a reader, not to a class
OURS = "course_kit"  # the kit's own key in the metadata of a cell
REPAIRS, REPAIRED = "repairs", "repaired"
_PREAMBLE = ("%", "import ", "from ", "#")
FILES, SETTINGS, SPEAKER_PAGE = "files", "settings", "speaker.html"  # in the presentation's folder
LABEXTENSIONS = PACKAGE / "presentation" / "labextension"
_COPIED = (LESSONS, "exercises")  # lessons link to exercises
_TEMPLATE = Path(__file__).parent / "templates" / "speaker.html"
# As wide as the page, so that what fits a line at 1024 pixels fits it at any width.
_SIZE = "clamp(16px, 1.95vw, 40px)"
_SETTINGS: dict[str, dict[str, Any]] = {
    "@jupyterlab/apputils-extension/themes.jupyterlab-settings": {
        "adaptive-theme": True,
        "overrides": {"code-font-size": _SIZE, "content-font-size1": _SIZE, "ui-font-size1": "16px"},
    },
    "@jupyterlab/apputils-extension/notification.jupyterlab-settings": {"fetchNews": "false", "checkForUpdates": False},
    "@jupyterlab/docmanager-extension/plugin.jupyterlab-settings": {"autosave": False},
    "@jupyterlab/notebook-extension/tracker.jupyterlab-settings": {"windowingMode": "none", "scrollPastEnd": True},
    "@jupyterlab/statusbar-extension/plugin.jupyterlab-settings": {"visible": False},
}


class PresentationError(GradingError):
    """It cannot be presented; the text is for the speaker."""


def list_demos(root: Path) -> list[Path]:
    """The demos in their order."""
    found = sorted(path for path in (root / DEMOS).glob("*.ipynb") if path.is_file())
    if not found:
        raise PresentationError(
            f"There are no demos in {root / DEMOS}. Fetch the course again, or restore that folder."
        )
    return found


def find_notebook(root: Path, name: str) -> Path:
    """The demo or lesson that a speaker names; the first demo for an empty name."""
    demos = list_demos(root)
    if not name:
        return demos[0]
    everything = [*demos, *sorted((root / LESSONS).glob("*.ipynb"))]
    wanted = name.replace("\\", "/").rstrip("/").rpartition("/")[2].removesuffix(".ipynb").lower().replace("-", "_")
    wanted = wanted.zfill(2) if wanted.isdecimal() else wanted
    begun = [path for path in demos if wanted and _names(path)[1].startswith(wanted)]
    for group in ([path for path in everything if wanted in _names(path)], begun):
        if len(group) == 1 or (group and wanted.isdecimal()):  # lessons have numbers, too: demos come first
            return group[0]
    several = [path for path in everything if wanted and wanted in path.stem]
    if len(several) == 1:
        return several[0]
    if several:
        raise PresentationError(f"'{name}' fits {_join_names(several)}. Type one of them.")
    by_name = {title: path.stem for path in everything for title in _names(path)[:2]}
    near = nearest_name(wanted, by_name)
    hint = f" Did you mean {by_name[near]}?" if near else ""
    raise PresentationError(f"There is no demo called '{name}'.{hint} The demos: {_join_names(demos)}.")


def _names(path: Path) -> tuple[str, ...]:
    """What a notebook may be called: 01_deadlock, deadlock, 01."""
    number, _, title = path.stem.partition("_")
    return path.stem, title, number


def _join_names(paths: list[Path]) -> str:
    return ", ".join(path.stem for path in paths)


def prepare_folder(root: Path, folder: Path, opened: Path) -> None:
    """Fill the folder of a presentation."""
    for name in _COPIED:
        kept_out = shutil.ignore_patterns(".ipynb_checkpoints")
        shutil.copytree(root / name, folder / FILES / name, ignore=kept_out, copy_function=shutil.copyfile)
    for copied in (path for path in (folder / FILES).rglob("*") if path.is_dir()):  # read-only, as the course's may be
        copied.chmod(0o700)
    spoken = []
    for path in dict.fromkeys((*list_demos(root), opened)):
        with suppress(PresentationError) if path != opened else nullcontext():
            spoken.append(_describe_notebook(path.relative_to(root).as_posix(), _read(path)))
    for path in (folder / FILES).rglob("*.ipynb"):
        with suppress(PresentationError):  # another one that is damaged is no reason not to show this one
            notebook = project_notebook(_read(path))
            notebook.metadata["language_info"] = workspace.language_info()  # or JupyterLab calls it unsaved
            nbformat.write(notebook, path)
    for name, values in _SETTINGS.items():
        path = folder / SETTINGS / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(values), encoding="utf-8")
    (folder / SPEAKER_PAGE).write_text(templates.render_template(_TEMPLATE, notebooks=spoken), encoding="utf-8")


def _read(path: Path) -> Any:
    try:
        return nbformat.read(path, as_version=4)
    except (ValueError, KeyError, AttributeError, TypeError, nbformat.ValidationError):
        raise PresentationError(f"{path} is damaged: it is not a notebook. Restore it, for example with git.") from None


def _describe_notebook(path: str, notebook: Any) -> dict[str, Any]:
    """What the speaker's window knows of a notebook; the notes as HTML."""
    from markupsafe import Markup
    from nbconvert.filters.markdown import markdown2html  # Jupyter Server brings it

    cells = []
    for cell in speaker_script(notebook):
        html = Markup(markdown2html("\n\n".join(cell.notes))) if cell.notes else ""  # noqa: S704 - the speaker's own
        cells.append({**asdict(cell), "notes": html})
    title, minutes = notebook_title(notebook), talk_minutes(notebook)
    return {"path": path, "title": title, "minutes": minutes, "cells": cells}


@dataclass(frozen=True)
class SpokenCell:
    """What a speaker needs to know of a cell of the projected copy."""

    cell_id: str
    kind: str
    label: str
    notes: list[str]  # those below it; the first has those at the very top, too


def project_notebook(notebook: Any) -> Any:
    """A notebook as a class sees it first: no outputs, no notes, no remarks, and the failure before the repair."""
    repairs = {repairs_of(cell): cell.source for cell in notebook.cells if repairs_of(cell)}
    notebook.cells = [cell for cell in notebook.cells if _is_projected(cell)]
    for cell in notebook.cells:
        cell.metadata = {OURS: {REPAIRED: repairs[cell.id]}} if cell.id in repairs else {}
        if cell.cell_type == "code":
            cell.outputs = []
            cell.execution_count = None
    return notebook


def speaker_script(notebook: Any) -> list[SpokenCell]:
    """What the speaker's window shows of a notebook, cell by cell; the repair is last before what follows it."""
    spoken: list[SpokenCell] = []
    at_the_top: list[str] = []
    for cell in notebook.cells:
        kind = "repair" if repairs_of(cell) else cell.cell_type
        if _is_notes(cell):
            (spoken[-1].notes if spoken else at_the_top).append(cell.source)
        elif kind == "repair" or _is_projected(cell):
            spoken.append(SpokenCell(cell.id, kind, _label(kind, cell.source), [] if spoken else at_the_top))
    return spoken


def talk_minutes(notebook: Any) -> int:
    """How long it takes with talk, as its first cell says; 0 where it does not."""
    stated = notebook.cells[0].metadata.get(OURS, {}).get("minutes", 0) if notebook.cells else 0
    return stated if isinstance(stated, int) else 0


def repairs_of(cell: Any) -> str:
    """The id of the failing cell that this cell repairs; empty if none."""
    return str(cell.metadata.get(OURS, {}).get(REPAIRS, ""))


def notebook_title(notebook: Any) -> str:
    """The first heading."""
    first = notebook.cells[0].source if notebook.cells else ""
    return _label("markdown", first)


def _is_notes(cell: Any) -> bool:
    return bool(cell.metadata.get("slideshow", {}).get("slide_type") == "notes")


def _is_projected(cell: Any) -> bool:
    return not _is_notes(cell) and {ANSWER, INSTRUCTOR, OFFSTAGE}.isdisjoint(cell.metadata.get("tags", []))


def _label(kind: str, source: str) -> str:
    """The line that says most of a cell: a heading, or the first that neither imports nor loads anything."""
    lines = [line.strip() for line in source.splitlines() if line.strip()]
    if kind == "markdown":
        return lines[0].lstrip("# ").replace("*", "").replace("`", "") if lines else ""
    telling = [line for line in lines if not line.startswith(_PREAMBLE)]
    return (telling or lines or [""])[0]

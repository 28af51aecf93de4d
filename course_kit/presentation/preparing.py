"""Fills the folder of a presentation: the copies, JupyterLab's settings, and the page of the speaker's window."""

from __future__ import annotations

import json
import shutil
from contextlib import nullcontext, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

import nbformat

from course_kit.environment import PACKAGE
from course_kit.learner import workspace
from course_kit.presentation import projected
from course_kit.presentation.demos import LESSONS, PresentationError, list_demos
from course_kit.text import templates

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
            notebook = projected.project_notebook(_read(path))
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
    for cell in projected.speaker_script(notebook):
        html = Markup(markdown2html("\n\n".join(cell.notes))) if cell.notes else ""  # noqa: S704 - the speaker's own
        cells.append({**asdict(cell), "notes": html})
    title, minutes = projected.notebook_title(notebook), projected.talk_minutes(notebook)
    return {"path": path, "title": title, "minutes": minutes, "cells": cells}

"""`course-kit present`: the demos and lessons in front of a class.

JupyterLab opens on copies that are made anew each time, so that no class sees what the one before has typed. Text
is enlarged, cells tagged `answer` are folded, outputs are empty, and nothing is saved by itself: closing a notebook
and opening it again is enough to begin from the start.
"""

from __future__ import annotations

import json
import shutil
import sys
from typing import TYPE_CHECKING, Any

import nbformat

from course_kit import environment
from course_kit.authoring.edition_notebooks import ANSWER
from course_kit.integrations import jupyter

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

FIRST_DEMO = "notebooks/demos/01_deadlock.ipynb"
SHOWN = ("notebooks", "exercises")
SETTINGS: dict[str, dict[str, Any]] = {
    "@jupyterlab/apputils-extension/themes.jupyterlab-settings": {
        "overrides": {"code-font-size": "20px", "content-font-size1": "21px", "ui-font-size1": "16px"}
    },
    "@jupyterlab/apputils-extension/notification.jupyterlab-settings": {"fetchNews": "false", "checkForUpdates": False},
    "@jupyterlab/docmanager-extension/plugin.jupyterlab-settings": {"autosave": False},
}


def run(arguments: Sequence[str]) -> int:
    """Replace this process by JupyterLab on fresh copies; 2 if they could not be made."""
    root = environment.checkout()
    if root is None or not (root / FIRST_DEMO).is_file():
        print("course-kit: the demos are missing. Run ./course present in the course's folder.", file=sys.stderr)
        return 2
    stage = environment.state_dir() / "present"
    try:
        prepare(root, stage)
    except OSError as problem:
        print(f"course-kit: the copies for the class could not be made in {stage}: {problem}.", file=sys.stderr)
        return 2
    settings = str(stage / "settings")
    return jupyter.serve(
        stage,
        FIRST_DEMO,
        arguments,
        JUPYTERLAB_SETTINGS_DIR=settings,
        JUPYTERLAB_WORKSPACES_DIR=f"{settings}/workspaces",
    )


def prepare(root: Path, stage: Path) -> None:
    """Make the copies; what is left of another class goes.

    Args:
        root: the course's folder.
        stage: the folder for the copies.

    Raises:
        OSError: it cannot be written.
    """
    if stage.exists():
        _make_writable(stage)
        shutil.rmtree(stage)
    for name in SHOWN:
        shutil.copytree(
            root / name,
            stage / name,
            ignore=shutil.ignore_patterns(".ipynb_checkpoints"),
            copy_function=shutil.copyfile,
        )
    _make_writable(stage)
    for path in stage.rglob("*.ipynb"):
        nbformat.write(for_a_class(nbformat.read(path, as_version=4)), path)
    for name, values in SETTINGS.items():
        path = stage / "settings" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(values), encoding="utf-8")


def _make_writable(folder: Path) -> None:
    """Let copies of folders that are read-only be changed, and removed before the next class."""
    for inner in (folder, *(path for path in folder.rglob("*") if path.is_dir())):
        inner.chmod(0o700)


def for_a_class(notebook: Any) -> Any:
    """A notebook without outputs, its answers folded away behind a click."""
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = []
            cell.execution_count = None
        if ANSWER in cell.metadata.get("tags", []):
            cell.metadata["jupyter"] = {"source_hidden": True}
    return notebook

"""What JupyterLab shows at a folder's first start."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from jupyterlab_server.workspaces_handler import WorkspacesManager

from course_kit.integrations import jupyter

if TYPE_CHECKING:
    from pathlib import Path


LAYOUT = "layout-restorer:data"


def test_the_next_day_opens_the_last_notebook_alone_and_the_table_of_contents_only_on_the_first(tmp_path: Path) -> None:
    workspaces = tmp_path / ".course" / "workspaces"
    assert jupyter.last_notebook(tmp_path) == jupyter.FIRST_LESSON
    jupyter.prepare_workspace(workspaces)
    manager = WorkspacesManager(str(workspaces))
    made = manager.load("default")
    assert made["data"][LAYOUT]["left"]["current"] == "@jupyterlab/toc:plugin"

    left = [f"notebook:notebooks/{number}.ipynb" for number in range(3)]
    made["data"][LAYOUT]["left"]["current"] = "filebrowser"
    made["data"][LAYOUT]["main"] = {"dock": {"type": "tab-area", "widgets": left}, "current": left[1]}
    made["data"] |= {name: {"data": {"path": name.partition(":")[2]}} for name in left}
    manager.save("default", json.dumps(made))
    (tmp_path / "notebooks").mkdir()
    (tmp_path / "notebooks" / "1.ipynb").touch()
    assert jupyter.last_notebook(tmp_path) == "notebooks/1.ipynb"
    jupyter.prepare_workspace(workspaces)
    again = manager.load("default")["data"]
    assert again[LAYOUT]["left"]["current"] == "filebrowser"
    assert again[LAYOUT]["main"]["dock"]["widgets"] == []
    assert not [name for name in again if name.startswith("notebook:")]


def test_a_damaged_workspace_stops_nothing(tmp_path: Path) -> None:
    workspaces = tmp_path / ".course" / "workspaces"
    jupyter.prepare_workspace(workspaces)
    [file] = workspaces.iterdir()
    file.write_text("{")
    jupyter.prepare_workspace(workspaces)
    assert jupyter.last_notebook(tmp_path) == jupyter.FIRST_LESSON

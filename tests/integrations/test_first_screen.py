"""What JupyterLab shows at a folder's first start."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jupyterlab_server.workspaces_handler import WorkspacesManager

from course_kit.integrations import jupyter

if TYPE_CHECKING:
    from pathlib import Path


def test_the_table_of_contents_is_open_until_the_learner_has_it_otherwise(tmp_path: Path) -> None:
    workspaces = tmp_path / "workspaces"
    jupyter.prepare(workspaces)
    made = WorkspacesManager(str(workspaces)).load("default")
    assert made["data"]["layout-restorer:data"]["left"]["current"] == "@jupyterlab/toc:plugin"
    [file] = workspaces.iterdir()
    file.write_text("the learner's")
    jupyter.prepare(workspaces)
    assert file.read_text() == "the learner's"

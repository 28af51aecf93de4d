"""What JupyterLab shows at a folder's first start: lesson 0, and beside it what is in it.

JupyterLab keeps how a window looked in a workspace, a file; a folder that has none yet gets one with the table of
contents open. What it asks at its first start, about news of the Jupyter project, is answered in `jupyter_config`.
"""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_WORKSPACE = "default"
_LEFT = ("filebrowser", "running-sessions", "@jupyterlab/toc:plugin", "extensionmanager.main-view")
_CONTENTS = "@jupyterlab/toc:plugin"
_LAYOUT = {
    "main": {"dock": {"type": "tab-area", "currentIndex": 0, "widgets": []}},
    "left": {"collapsed": False, "visible": True, "current": _CONTENTS, "widgets": list(_LEFT)},
    "right": {"collapsed": True, "visible": True, "widgets": []},
    "relativeSizes": [0.2, 0.8, 0],
}


def prepare(workspaces: Path) -> None:
    """Write the first workspace of a folder, unless it has one; where that fails, Jupyter's own default counts."""
    with suppress(OSError):
        if workspaces.is_dir() and any(workspaces.iterdir()):
            return
        from jupyterlab_server.workspaces_handler import WorkspacesManager  # takes half a second

        workspaces.mkdir(parents=True, exist_ok=True)
        data = {"layout-restorer:data": _LAYOUT, "file-browser-filebrowser:cwd": {"path": "notebooks"}}
        WorkspacesManager(str(workspaces)).save(_WORKSPACE, json.dumps({"data": data, "metadata": {"id": _WORKSPACE}}))

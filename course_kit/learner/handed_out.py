"""A file as a learner gets it: a notebook opens without outputs, which would tell what its cells will show.

The repository's notebooks keep their outputs, and nbval compares them. JupyterLab writes into each notebook in which
language its kernel runs, and then calls it unsaved; so a copy says that already.
"""

from __future__ import annotations

import hashlib
import json
import platform
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

_NOTEBOOK = ".ipynb"


def as_handed_out(name: str, content: bytes) -> bytes:
    """The content of a file of the course as a learner gets it; a damaged notebook stays as it is."""
    notebook = _notebook(name, content)
    if notebook is None:
        return content
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["outputs"], cell["execution_count"] = [], None
    return _of_this_python(notebook)


def of_this_python(content: bytes) -> bytes:
    """A learner's notebook, with outputs and all, that JupyterLab opens with this Python and does not call unsaved."""
    notebook = _notebook(_NOTEBOOK, content)
    if notebook is None or notebook.get("metadata", {}).get("language_info") == language_info():
        return content
    return _of_this_python(notebook)


def language_info() -> dict[str, Any]:
    """What the kernel of this Python says of its language, which JupyterLab writes into the notebook."""
    return {
        "codemirror_mode": {"name": "ipython", "version": sys.version_info.major},
        "file_extension": ".py",
        "mimetype": "text/x-python",
        "name": "python",
        "nbconvert_exporter": "python",
        "pygments_lexer": f"ipython{sys.version_info.major}",
        "version": platform.python_version(),
    }


def digest(name: str, content: bytes) -> str:
    """What a learner has written in a file, as a hash: of a notebook its cells, whatever their outputs are."""
    notebook = _notebook(name, content)
    if notebook is not None:
        cells = [[cell["cell_type"], _text(cell.get("source", ""))] for cell in notebook["cells"]]
        content = json.dumps(cells).encode()
    return hashlib.sha256(content).hexdigest()


def digest_of(path: Path) -> str | None:
    """The hash of a file; None where there is none, and "" for what is no file or cannot be read: nobody's hash."""
    try:
        return digest(path.name, path.read_bytes())
    except FileNotFoundError:
        return None
    except (IsADirectoryError, PermissionError):
        return ""


def _of_this_python(notebook: dict[str, Any]) -> bytes:
    notebook.setdefault("metadata", {})["language_info"] = language_info()
    try:
        return f"{json.dumps(notebook, indent=1, ensure_ascii=False)}\n".encode()
    except UnicodeEncodeError:  # half of a surrogate pair, which JSON can spell and UTF-8 cannot
        return f"{json.dumps(notebook, indent=1)}\n".encode()


def _notebook(name: str, content: bytes) -> dict[str, Any] | None:
    """A notebook's content; None for anything else."""
    if not name.endswith(_NOTEBOOK):
        return None
    try:
        found: dict[str, Any] = json.loads(content)
        whole = all(isinstance(cell["cell_type"], str) for cell in found["cells"])
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return found if whole and isinstance(found.get("metadata", {}), dict) else None


def _text(source: object) -> str:
    return "".join(map(str, source)) if isinstance(source, list) else str(source)

"""Folders for Jupyter and IPython where the usual ones cannot be written: a home that is missing, read-only, root's."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from jupyter_core import paths

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Callable


def _ipython_dir() -> str:
    return os.environ.get("IPYTHONDIR") or str(Path.home() / ".ipython")


# Which variable sets a folder, where it usually is, and the variable by which an old one is still read.
_FOLDERS: dict[str, tuple[Callable[[], str], str]] = {
    "JUPYTER_CONFIG_DIR": (paths.jupyter_config_dir, "JUPYTER_CONFIG_PATH"),
    "JUPYTER_DATA_DIR": (paths.jupyter_data_dir, "JUPYTER_PATH"),
    "JUPYTER_RUNTIME_DIR": (paths.jupyter_runtime_dir, ""),
    "IPYTHONDIR": (_ipython_dir, ""),
}


def replacements() -> dict[str, str]:
    """Variables for a Jupyter server and its kernels; empty where the usual folders can be written."""
    spare = environment.state_dir() / "jupyter"
    found: dict[str, str] = {}
    for name, (usual, search_path) in _FOLDERS.items():
        old = _where(usual)
        if old is not None and environment.is_writable(old):
            continue
        found[name] = str(spare / name.lower())
        if search_path and old is not None and old.is_dir():
            before = os.environ.get(search_path)
            found[search_path] = f"{before}{os.pathsep}{old}" if before else str(old)
    if _where(lambda: str(Path.home())) is None:
        found["HOME"] = str(environment.state_dir())  # without any, Jupyter itself does not start
    return found


def _where(usual: Callable[[], str]) -> Path | None:
    """The folder; None where nobody knows the home directory that it lies in."""
    try:
        return Path(usual())
    except RuntimeError:
        return None

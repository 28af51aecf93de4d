"""Finds the Pythons of this machine that the course runs on."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

OLDEST, NEWEST = (3, 10), (3, 14)
_PROBE_S = 20.0
# `_base_executable` is the Python itself where we ask one of a virtual environment, or a script that leads to it.
_PROBE = """
import importlib.util, json, platform, sys, sysconfig
print(json.dumps({
    "version": sys.version_info[:3],
    "path": getattr(sys, "_base_executable", None) or sys.executable,
    "fits": sys.implementation.name == "cpython" and not sysconfig.get_config_var("Py_GIL_DISABLED"),
    "has_venv": all(importlib.util.find_spec(name) for name in ("venv", "ensurepip")),
}))
"""


@dataclass(frozen=True)
class Interpreter:
    """A Python that starts.

    Attributes:
        version: major, minor and micro.
        path: its executable.
        has_venv: whether it can make an environment with pip by itself; Debian's needs a package for that.
    """

    version: tuple[int, int, int]
    path: str
    has_venv: bool

    @property
    def minor(self) -> str:
        """The version as people call it, such as "3.12"."""
        return f"{self.version[0]}.{self.version[1]}"

    def __str__(self) -> str:
        return ".".join(map(str, self.version))


def wanted() -> list[str]:
    """The versions that the course is for, oldest first, such as "3.10"."""
    return [f"{OLDEST[0]}.{minor}" for minor in range(OLDEST[1], NEWEST[1] + 1)]


def find() -> list[Interpreter]:
    """One Python of each version that the course is for, as far as there is one, oldest first.

    They are looked for on PATH, among those of pyenv and among those that uv has fetched.
    """
    best: dict[str, Interpreter] = {}
    asked: set[str] = set()
    for path in _candidates():
        real = os.path.realpath(path)
        if real in asked or not os.access(path, os.X_OK):
            continue
        asked.add(real)
        found = _ask(path)
        if found is None or not OLDEST <= found.version[:2] <= NEWEST:
            continue
        known = best.get(found.minor)
        if known is None or (found.has_venv, found.version) > (known.has_venv, known.version):
            best[found.minor] = found
    return sorted(best.values(), key=lambda one: one.version)


def find_uv() -> str | None:
    """The uv of this environment, or the one on PATH; None where there is none."""
    return shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))


def _candidates() -> Iterator[Path]:
    yield Path(sys.executable)
    for folder in os.get_exec_path():
        yield from (Path(folder, f"python{version}") for version in ("3", *wanted()))
    home = Path(os.environ.get("HOME", "/"))
    data = Path(os.environ.get("XDG_DATA_HOME", home / ".local/share"))
    fetched_by_uv = Path(os.environ.get("UV_PYTHON_INSTALL_DIR", data / "uv/python"))
    shims = [Path(folder).parent for folder in os.get_exec_path() if Path(folder).name == "shims"]
    pyenvs = [Path(os.environ.get("PYENV_ROOT", home / ".pyenv")), *shims]
    for versions in (*(pyenv / "versions" for pyenv in pyenvs), fetched_by_uv):
        yield from sorted(versions.glob("*/bin/python3"))


def _ask(path: Path) -> Interpreter | None:
    """What a Python says about itself; None for one that does not start, such as a script of pyenv's without one."""
    try:
        done = subprocess.run(
            [str(path), "-I", "-c", _PROBE], capture_output=True, text=True, timeout=_PROBE_S, check=False
        )
        said: dict[str, Any] = json.loads(done.stdout)
    except (OSError, ValueError, subprocess.TimeoutExpired):
        return None
    if not said["fits"]:
        return None
    major, minor, micro = said["version"]
    return Interpreter((major, minor, micro), said["path"], said["has_venv"])

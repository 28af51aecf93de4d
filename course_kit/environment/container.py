"""Whether this is the inside of a container, where being root is usual and harms nobody."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_FILES = (".dockerenv", "run/.containerenv", "run/systemd/container")  # Docker, Podman, systemd-nspawn
_VARIABLES = ("container", "KUBERNETES_SERVICE_HOST")  # most engines set the first for all processes
_CGROUPS = (
    "docker",
    "kubepods",
    "containerd",
    "libpod",
    "lxc",
)  # in the names of process 1's, with cgroups of version 1


def sign_of_container(root: Path = Path("/"), environ: Mapping[str, str] = os.environ) -> str:
    """What shows that this is a container, for people: `/.dockerenv`; empty where nothing does."""
    for name in _FILES:
        if (root / name).exists():
            return f"/{name}"
    for name in _VARIABLES:
        if environ.get(name):
            return f"the variable {name}"
    with suppress(OSError):  # /proc/1/environ is for root alone, and not always even for root
        if any(pair.startswith(b"container=") for pair in (root / "proc/1/environ").read_bytes().split(b"\0")):
            return "/proc/1/environ"
    with suppress(OSError):
        groups = (root / "proc/1/cgroup").read_text(encoding="utf-8", errors="replace")
        if any(name in groups for name in _CGROUPS):
            return "/proc/1/cgroup"
    return ""

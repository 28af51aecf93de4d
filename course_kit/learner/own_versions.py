"""What git knows of a clone's files that somebody has changed in it: learners get the committed ones."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

_OF_GIT_S = 20.0


def committed(root: Path, folders: Sequence[str]) -> dict[str, bytes]:
    """By path the last commit's version of each file that differs from it or is gone; empty where git knows nothing."""
    listed = _git(root, "diff", "--name-only", "--relative", "--diff-filter=MD", "-z", "HEAD", "--", *folders)
    found = {path: _git(root, "show", f"HEAD:./{path}") for path in (listed or b"").decode().split("\0") if path}
    return {path: content for path, content in found.items() if content is not None}


def _git(root: Path, *arguments: str) -> bytes | None:
    """What a command of git prints; None where it fails, or there is no git."""
    try:
        ran = subprocess.run(
            ["git", *arguments], cwd=root, stdin=subprocess.DEVNULL, capture_output=True, timeout=_OF_GIT_S, check=False
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return ran.stdout if ran.returncode == 0 else None

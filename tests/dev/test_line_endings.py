"""A clone by Git for Windows, used in WSL, has no CRLF: with it neither `./course` nor any `#!` line starts."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parent.parent.parent
PICTURE = b"\x89PNG\r\n\x1a\n\0\0\r\n"  # tells whether line endings were changed; that is what its first bytes are for


def git(folder: Path, *arguments: str) -> None:
    environ = {**os.environ, "GIT_CONFIG_NOSYSTEM": "1", "GIT_CONFIG_GLOBAL": os.devnull}
    names = ("-c", "user.name=Somebody", "-c", "user.email=somebody@example.org")
    subprocess.run(["git", *names, *arguments], cwd=folder, env=environ, check=True, capture_output=True, timeout=60)


def test_a_clone_of_git_for_windows_starts(tmp_path: Path) -> None:
    course, clone = tmp_path / "course", tmp_path / "clone"
    course.mkdir()
    for name in (".gitattributes", "course", "README.md"):
        shutil.copy(REPOSITORY / name, course)
    (course / "picture.png").write_bytes(PICTURE)
    git(course, "init", "--quiet")
    git(course, "add", "--all")
    git(course, "commit", "--quiet", "--message", "All")
    git(tmp_path, "clone", "--quiet", "--config", "core.autocrlf=true", str(course), str(clone))
    for name in ("course", "README.md", "picture.png"):
        assert (clone / name).read_bytes() == (course / name).read_bytes(), name
    shown = subprocess.run([clone / "course", "help"], capture_output=True, text=True, timeout=60, check=False)
    assert (shown.returncode, shown.stdout[:15]) == (0, "Usage: ./course")

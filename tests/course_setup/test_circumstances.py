"""Machines, folders and variables that are not as one would like them: made to work, or refused in a sentence."""

from __future__ import annotations

import errno
import graphlib
import os
import platform
import resource
import shutil
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.sandbox.namespaces import drop_privileges
from course_setup import problems
from tests.course_clone import BASE_PYTHON, STAND_IN_UV, Clone

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Iterator

NEEDED = ("sh", "cat", "chmod", "cksum", "dirname", "env", "getconf", "readlink", "rm", "uname")
OLD_PYTHON = """#!/bin/sh
case "$*" in *"version_info[:3]"*) echo 3.9.2 ;; *) exit 1 ;; esac
"""

# Answers questions as the Python of a sourced ROS 2 would, and leaves installing to the stand-in.
REAL_PYTHON = """#!/bin/sh
echo "$@" >>"{asked}"
case $1 in -m) exec "${{0%/*}}/ros_python" "$@" ;; *) PYTHONPATH="{ros}" exec "{python}" "$@" ;; esac
"""


def refusal(done: subprocess.CompletedProcess[str]) -> str:
    """The one line with which a command refused."""
    assert done.returncode == 2, done
    [line] = done.stderr.splitlines()
    return line


@pytest.fixture
def bare(clone: Clone, tmp_path: Path) -> dict[str, str]:
    """Variables for a machine without any Python: PATH has only what a POSIX system cannot be without."""
    for name in NEEDED:
        (clone.tools / name).symlink_to(str(shutil.which(name)))
    return {"PATH": str(clone.tools), "COURSE_PYTHON": "", "HOME": str(tmp_path / "home")}


@contextmanager
def not_writable(*folders: Path) -> Iterator[None]:
    """Folders of somebody else, so to speak; root notices only after `drop_privileges`."""
    for folder in folders:
        folder.chmod(0o555)
    try:
        yield
    finally:
        for folder in folders:
            folder.chmod(0o755)


@pytest.mark.parametrize(
    ("name", "word"),
    [("a:b", "':'"), ("a;b", "';'")],
)
def test_names_of_folders_that_cannot_work_are_refused_at_once(tmp_path: Path, name: str, word: str) -> None:
    clone = Clone(tmp_path, name)
    done = clone.course("lab")
    assert done.returncode == 2
    assert word in done.stderr
    assert "Rename the folder" in done.stderr
    assert clone.calls() == []


def test_packages_from_elsewhere_are_left_aside_unless_ros_brings_them(clone: Clone, tmp_path: Path) -> None:
    (clone.root / "course_kit" / "cli" / "main.py").write_text("import graphlib; print(graphlib.__file__)\n")
    (tmp_path / "graphlib.py").touch()
    for _ in range(2):
        done = clone.course("doctor", PYTHONPATH=str(tmp_path))
        assert done.stdout == f"{graphlib.__file__}\n", done.stderr
        assert "PYTHONPATH is set; the course runs without it" in done.stderr
    sourced = clone.course("doctor", PYTHONPATH=str(tmp_path), **clone.sourced())
    assert sourced.stdout == f"{tmp_path}/graphlib.py\n"
    assert "PYTHONPATH" not in sourced.stderr


def test_looking_for_a_python_loads_nothing_from_the_folder_that_one_is_in(clone: Clone, tmp_path: Path) -> None:
    """Each question is asked of a real Python, from among traps: for the one of a sourced ROS, and for any."""
    inbox = tmp_path / "inbox"
    inbox.mkdir()
    for name in ("rclpy", "numpy", "platform", "venv", "ensurepip", "json"):
        (inbox / f"{name}.py").write_text(f"open({str(tmp_path / 'loaded')!r}, 'a').write(__name__)\n")
    for name in ("rclpy", "numpy"):
        (tmp_path / "ros" / name).mkdir(parents=True)
        (tmp_path / "ros" / name / "__init__.py").write_text("__version__ = '1.26.4'\n")
    sourced = {**clone.sourced(), "COURSE_PYTHON": str(clone.tools / "real_python")}
    clone.tool("real_python", REAL_PYTHON.format(asked=tmp_path / "asked", ros=tmp_path / "ros", python=BASE_PYTHON))
    (clone.tools / "uv").unlink()
    clone.course("doctor", cwd=inbox, PIP_NO_INDEX="1", PIP_FIND_LINKS="", **sourced)
    clone.tool("uv", STAND_IN_UV)
    clone.course("doctor", cwd=inbox, **sourced)
    (clone.tools / "uv").unlink()
    asked = (tmp_path / "asked").read_text()
    assert all(word in asked for word in ("import rclpy", "import ensurepip", "import numpy"))
    clone.tool("python3", f'#!/bin/sh\ncase $* in *implementation*) exit 1 ;; esac\nexec {BASE_PYTHON} "$@"\n')
    for name in ("python3.12", "python3.13", "python3.14", "python3.11", "python3.10", "python"):
        clone.tool(name, "#!/bin/sh\nexit 1\n")
    told = refusal(clone.course("doctor", cwd=inbox, COURSE_PYTHON="", HOME=""))
    assert f"{platform.python_version()} ({clone.tools / 'python3'})" in told
    assert not (tmp_path / "loaded").exists(), (tmp_path / "loaded").read_text()


def test_the_installer_gets_no_settings_for_other_installations(clone: Clone, tmp_path: Path) -> None:
    others = {"PYTHONPATH": str(tmp_path), "VIRTUAL_ENV": "/x", "PIP_TARGET": "/x", "PIP_USER": "1"}
    clone.course("doctor", **clone.sourced(), **others)
    given = dict(line.split("=", 1) for line in Path(f"{clone.log}.variables").read_text().splitlines() if "=" in line)
    assert not given.keys() & {"PYTHONPATH", "VIRTUAL_ENV", "PIP_TARGET"}
    assert (given["PIP_USER"], given["LC_ALL"], given["PYTHONUTF8"]) == ("0", "C.UTF-8", "1")
    assert given["TMPDIR"].startswith(f"{clone.root}/.venvs/")
    assert not Path(given["TMPDIR"]).exists()


def test_a_folder_that_cannot_be_written_is_refused_at_once(clone: Clone) -> None:
    with not_writable(clone.root):
        told = refusal(clone.course("lab", before=drop_privileges))
    assert f"must be set up in {clone.root}, but this folder is not writable (Permission denied)" in told
    # A Python in the owner's home is the owner's alone.
    assert "ask its owner to run 'COURSE_PYTHON=/usr/bin/python3 ./course lab' once" in told
    assert clone.calls() == []


def test_a_complete_course_works_in_a_folder_that_cannot_be_written(clone: Clone) -> None:
    sourced = clone.sourced()
    clone.course("doctor", **sourced)
    clone.course("doctor")
    with not_writable(clone.root, clone.root / ".venvs"):
        done = clone.course("doctor", before=drop_privileges, **sourced)
        assert (done.returncode, done.stderr) == (0, "")
        assert "/.venvs/jazzy-" in done.stdout
        assert "not writable" in refusal(clone.course("test", before=drop_privileges))


def test_only_an_old_python_is_named_with_what_to_do(clone: Clone, bare: dict[str, str]) -> None:
    (clone.tools / "uv").unlink()
    assert "this machine has none" in refusal(clone.course("lab", **bare))
    clone.tool("python3", OLD_PYTHON)
    told = refusal(clone.course("lab", **bare))
    assert f"The course needs Python 3.10 to 3.14, and this machine has 3.9.2 ({clone.tools}/python3)." in told
    assert "uv, which brings a Python of its own" in told


def test_uv_alone_is_enough(clone: Clone, bare: dict[str, str]) -> None:
    clone.tool("python3", OLD_PYTHON)
    done = clone.course("doctor", **bare)
    assert done.returncode == 0, done.stderr
    assert clone.calls() == ["run", "venv", "pip"]


def test_a_disk_that_takes_no_more_leaves_nothing_behind(clone: Clone) -> None:
    """A limit on the size of files stands in for the full disk."""
    done = clone.course("lab", before=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (0, resource.RLIM_INFINITY)))
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("course: ")
    assert clone.environments() == set()
    assert clone.course("doctor").returncode == 0


@pytest.mark.parametrize(
    ("number", "word"),
    [
        (errno.ENOSPC, "The disk is full. The course needs about 500 MB in /a course."),
        (errno.EDQUOT, "The disk is full."),
        (errno.EROFS, "is not writable (Read-only file system)"),
        (errno.EIO, "The set-up failed (Input/output error: /a course/x)."),
    ],
)
def test_errors_of_the_system_are_sentences(number: int, word: str) -> None:
    problem = OSError(number, os.strerror(number), "/a course/x")
    assert word in problems.describe(problem, Path("/a course"), "wheels")


def test_a_folder_in_which_nothing_may_be_run_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only root can mount such a file system, so its status is stood in for."""
    real = os.statvfs(tmp_path)
    stand_in = os.statvfs_result((*real[:8], real.f_flag | os.ST_NOEXEC, real.f_namemax))
    monkeypatch.setattr(os, "statvfs", lambda _path: stand_in)
    with pytest.raises(problems.SetUpError, match=r"mounted 'noexec'.*Move the course's folder"):
        problems.require_usable(tmp_path, tmp_path / ".venvs")
    assert not (tmp_path / ".venvs").exists()

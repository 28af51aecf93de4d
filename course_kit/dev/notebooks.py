"""`course-kit dev notebooks`: nbval on every lesson and drill of the course, each output compared.

Of the test tools it needs nbval alone, and pytest, which that brings.
"""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.text.console import refuse

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_AT_ONCE = 3  # notebooks wait for nodes more than they compute
# What else there is to set, and a ROS graph for each run, is in conftest.py.
NBVAL = ["-c", "tests/nbval.ini", "--rootdir=.", "--confcutdir=.", "--nbval", "-p", "no:cacheprovider"]


def main(arguments: Sequence[str]) -> int:
    """Run the notebooks named on the command line, or all."""
    if find_spec("nbval") is None:
        return refuse(
            "nbval, which compares the outputs, is not installed here. It comes with the test tools: run "
            "./course test tests/text once, then this again."
        )
    root = environment.checkout_folder()
    if root is None:
        return refuse("the notebooks belong to the course's folder; run this in a clone of it.")
    paths = [Path(os.path.relpath(name, root)) for name in arguments]
    os.chdir(root)
    return run_notebooks(environment.child_environment(COURSE_KIT_PROGRESS="off"), paths)


def list_with_outputs(course: Path, *, drills: bool = True) -> list[Path]:
    """The notebooks of a course whose outputs are stored: its lessons, demos and drills."""
    folders = ("notebooks", "exercises/drills") if drills else ("notebooks",)
    found = [path for folder in folders for path in (course / folder).rglob("*.ipynb")]
    return sorted(path for path in found if ".ipynb_checkpoints" not in path.parts)


def run_notebooks(environ: Mapping[str, str], paths: Sequence[Path] = ()) -> int:
    """Run nbval, strict, over notebooks (all when none is named), side by side; 0 when every output was as stored."""
    longest_first = sorted(paths or list_with_outputs(Path()), key=lambda path: path.stat().st_size, reverse=True)
    with ThreadPoolExecutor(_AT_ONCE) as threads:
        return max(threads.map(lambda path: _run_one(path, environ), longest_first), default=2)


def _run_one(path: Path, environ: Mapping[str, str]) -> int:
    ran = subprocess.run(
        [sys.executable, "-m", "pytest", *NBVAL, str(path)],
        env=dict(environ),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    print(ran.stdout, flush=True)
    return ran.returncode

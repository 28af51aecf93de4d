"""`course-kit dev notebooks`: nbval on every lesson and drill of the course, each output compared.

Of the test tools it needs nbval alone, and pytest, which that brings.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

_KIT = "ros2-course-kit"
_AT_ONCE = 3  # notebooks wait for nodes more than they compute
_TABLE = Path("artifacts/nbval_times.md")
CELL_TIMEOUT_S = 60.0  # a cell that waits longer than this hangs; nbval's own default is 2,000 s
NBVAL = [
    "-c",
    "tests/nbval.ini",
    "--rootdir=.",
    "--nbval",
    "--nbval-current-env",
    f"--nbval-cell-timeout={CELL_TIMEOUT_S:g}",
    "--nbval-sanitize-with=tests/nbval_sanitize.cfg",
    "-p",
    "course_kit.dev.nbval_plugin",
    "-p",
    "no:cacheprovider",
]


def requirement() -> str:
    """What the kit's test tools ask of nbval, for pip."""
    wanted = next(one for one in metadata.requires(_KIT) or () if one.startswith("nbval"))
    return wanted.partition(";")[0].strip()


def main(arguments: Sequence[str]) -> int:
    """Run the notebooks named on the command line, or all."""
    if find_spec("nbval") is None:
        return cannot(
            "nbval, which compares the outputs, is not installed here. It comes with the test tools: run "
            "./course test tests/text once, then this again."
        )
    root = environment.checkout()
    if root is None:
        return cannot("the notebooks belong to the course's folder; run this in a clone of it.")
    paths = [Path(name).resolve() for name in arguments]
    os.chdir(root)
    return run(
        environment.child_environment(COURSE_KIT_PROGRESS="off"), [Path(os.path.relpath(path)) for path in paths]
    )


def with_outputs(course: Path, *, drills: bool = True) -> list[Path]:
    """The notebooks of a course whose outputs are stored: its lessons, demos and drills.

    Args:
        course: its folder.
        drills: whether its drills are wanted, too.
    """
    folders = ("notebooks", "exercises/drills") if drills else ("notebooks",)
    found = [path for folder in folders for path in (course / folder).rglob("*.ipynb")]
    return sorted(path for path in found if ".ipynb_checkpoints" not in path.parts)


def run(environ: Mapping[str, str], paths: Sequence[Path] = ()) -> int:
    """Run nbval, strict, over notebooks of the course: three at a time, each on a graph of its own.

    Prints what each has printed when it is done, and how long each took; the table is kept in artifacts/.

    Args:
        environ: the environment of the notebooks, but for their ROS domain.
        paths: which, relative to the course's folder, in which this process has to be; all when none is named.

    Returns:
        0 when every output was as it is stored.
    """
    paths = sorted(paths or with_outputs(Path()), key=lambda path: path.stat().st_size, reverse=True)  # long ones first
    with ThreadPoolExecutor(_AT_ONCE) as threads:
        ran = list(threads.map(lambda path: _run_one(path, environ), paths))
    rows = [
        f"| {path.as_posix()} | {seconds:.1f} s | {'passed' if code == 0 else 'FAILED'} |"
        for path, (code, seconds) in zip(paths, ran, strict=True)
    ]
    table = "\n".join(["| notebook | nbval | |", "|---|---|---|", *rows])
    print(f"\n{table}\n")
    _TABLE.parent.mkdir(exist_ok=True)
    _TABLE.write_text(f"{table}\n", encoding="utf-8")
    return max((code for code, _ in ran), default=2)


def _run_one(path: Path, environ: Mapping[str, str]) -> tuple[int, float]:
    """Exit code and seconds of one notebook."""
    began = time.monotonic()
    with environment.exclusive_domain() as domain_id:
        ran = subprocess.run(
            [sys.executable, "-m", "pytest", *NBVAL, str(path)],
            env={**environ, "ROS_DOMAIN_ID": str(domain_id)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
    print(ran.stdout, flush=True)
    return ran.returncode, time.monotonic() - began

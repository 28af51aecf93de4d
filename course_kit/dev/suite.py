"""`./course test`: pytest on the tests, then nbval on the notebooks, with nothing installed by hand.

With arguments, they go to pytest as they are, and that one run is all: `./course test tests/lab -k replace`.
"""

from __future__ import annotations

import os
import subprocess
import sys

from course_kit import environment
from course_kit.dev import browser

NBVAL = [
    "--nbval",
    "--nbval-current-env",
    "--nbval-cell-timeout=60",  # a cell that waits longer than this hangs; nbval's own default is 2,000 s
    "--nbval-sanitize-with=tests/nbval_sanitize.cfg",
    "-p",
    "course_kit.dev.nbval_plugin",
]


def main(arguments: list[str]) -> int:
    """Run the suite and return its exit code: 0 when everything passed."""
    root = environment.checkout()
    if root is None:
        print("course: the tests belong to the course's folder; run ./course test there.", file=sys.stderr)
        return 2
    os.chdir(root)
    environ = environment.child_environment(COURSE_BROWSER=browser.find_or_install(), COURSE_KIT_PROGRESS="off")
    try:
        if arguments:
            return pytest(arguments, environ)
        tests = pytest(["tests"], environ)
        return notebooks(environ) or tests
    except KeyboardInterrupt:  # pytest, which got it too, has said so
        return 130


def pytest(arguments: list[str], environ: dict[str, str]) -> int:
    """Run pytest in a process of its own."""
    return subprocess.run([sys.executable, "-m", "pytest", *arguments], env=environ, check=False).returncode


def notebooks(environ: dict[str, str]) -> int:
    """Run nbval, strict, over the course on a graph of its own."""
    with environment.exclusive_domain() as domain_id:
        return pytest([*NBVAL, "notebooks"], {**environ, "ROS_DOMAIN_ID": str(domain_id)})


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

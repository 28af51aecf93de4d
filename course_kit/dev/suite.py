"""`./course test`: pytest on the tests, then nbval on the notebooks, with nothing installed by hand.

With arguments, they go to pytest as they are, and that one run is all: `./course test tests/lab -k replace`.
"""

from __future__ import annotations

import os
import subprocess
import sys

from course_kit import environment
from course_kit.dev import browser

# A cell that waits longer than this hangs; nbval's own default is 2,000 s.
NBVAL = [
    "--nbval",
    "--nbval-current-env",
    "--nbval-cell-timeout=60",
    "--nbval-sanitize-with",
    "tests/nbval_sanitize.cfg",
]


def main(arguments: list[str]) -> int:
    """Run the suite and return its exit code: 0 when everything passed."""
    root = environment.checkout()
    if root is None:
        print("course: the tests belong to the course's folder; run ./course test there.", file=sys.stderr)
        return 2
    os.chdir(root)
    chromium = browser.find_or_install()
    environ = environment.child_environment(COURSE_BROWSER=chromium or None)
    if chromium is None and not arguments and not os.environ.get("CI"):
        print(
            "course: no Chromium here, so the browser tests are left out (everything else runs). "
            "Debian, Ubuntu: sudo apt install chromium",
            file=sys.stderr,
        )
        arguments = ["-m", "not browser", "tests"]
    pytest = [sys.executable, "-m", "pytest"]
    if arguments and arguments[0] != "-m":
        return subprocess.run([*pytest, *arguments], env=environ, check=False).returncode
    tests = subprocess.run([*pytest, *(arguments or ["tests"])], env=environ, check=False).returncode
    return notebooks(environ) or tests


def notebooks(environ: dict[str, str]) -> int:
    """Run nbval, strict, over the course on a graph of its own."""
    with environment.exclusive_domain() as domain_id:
        command = [sys.executable, "-m", "pytest", *NBVAL, "notebooks"]
        return subprocess.run(command, env={**environ, "ROS_DOMAIN_ID": str(domain_id)}, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

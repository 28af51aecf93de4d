"""`./course test`: pytest on the tests, nbval on the notebooks, and on CI the course on other Pythons.

With arguments, they go to pytest as they are, and that one run is all: `./course test tests/lab -k replace`. With
`--matrix` the course is tried on other Pythons, too, wherever that is (see `matrix`).
"""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.util import find_spec

from course_kit import environment
from course_kit.dev import browser, notebooks

# Tests wait for nodes more than they compute, but with more workers than cores some of them wait too long. Files stay
# together: their fixtures are dear.
SIDE_BY_SIDE = ["-n", "auto", "--maxprocesses", "4", "--dist", "loadfile"]
MATRIX = "--matrix"


def main(arguments: list[str]) -> int:
    """Run the suite and return its exit code: 0 when everything passed."""
    environment.heed_interrupts()
    root = environment.checkout()
    if root is None:
        print("course: the tests belong to the course's folder; run ./course test there.", file=sys.stderr)
        return 2
    os.chdir(root)
    chosen = [argument for argument in arguments if argument != MATRIX]
    on_ci = bool(os.environ.get("CI")) and not arguments
    # The tests start thousands of Pythons; each would compile the course anew.
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    try:
        environ = environment.child_environment(COURSE_BROWSER=browser.find_or_install(), COURSE_KIT_PROGRESS="off")
        if chosen:
            codes = [pytest(chosen, environ)]
        else:
            codes = [pytest([*SIDE_BY_SIDE, "tests"], environ), notebooks.run(environ)]
        if on_ci or MATRIX in arguments:
            codes.append(_matrix())
    except environment.DomainError as problem:
        print(f"course: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:  # pytest, which got it too, has said so
        return 130
    return next((code for code in codes if code), 0)


def _matrix() -> int:
    """Try the course on other Pythons; the student edition cannot, and says so."""
    if find_spec("course_kit.dev.matrix") is None:
        print("course: this edition of the course has no test of other Pythons.", file=sys.stderr)
        return 0
    from course_kit.dev import matrix

    return matrix.main([matrix.ENDS])


def pytest(arguments: list[str], environ: dict[str, str]) -> int:
    """Run pytest in a process of its own."""
    return subprocess.run([sys.executable, "-m", "pytest", *arguments], env=environ, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""`./course test`: pytest on the tests, then nbval on the notebooks, with nothing installed by hand.

With arguments, they go to pytest as they are, and that one run is all: `./course test tests/lab -k replace`. Alone,
`--notebooks` runs the notebooks and `--matrix` the fast part of the suite on other Pythons, as CI does after all else.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from course_kit import environment
from course_kit.dev import browser, matrix

# Tests wait for nodes more than they compute. Files stay together: their fixtures are dear.
_NOTEBOOKS_AT_ONCE = 2
_QUEUE_S = 60.0  # for a ROS domain, where others have all of them
SIDE_BY_SIDE = ["-n", "auto", "--maxprocesses", "4", "--dist", "loadfile"]

NOTEBOOKS, MATRIX = "--notebooks", "--matrix"  # one part of the suite alone

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
    environment.heed_interrupts()
    root = environment.checkout()
    if root is None:
        print("course: the tests belong to the course's folder; run ./course test there.", file=sys.stderr)
        return 2
    os.chdir(root)
    try:
        environ = environment.child_environment(COURSE_BROWSER=browser.find_or_install(), COURSE_KIT_PROGRESS="off")
        return _run(arguments, environ)
    except environment.DomainError as problem:
        print(f"course: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:  # pytest, which got it too, has said so
        return 130


def _run(arguments: list[str], environ: dict[str, str]) -> int:
    parts = {NOTEBOOKS: lambda: notebooks(environ), MATRIX: lambda: matrix.main([])}
    if len(arguments) == 1 and arguments[0] in parts:
        return parts[arguments[0]]()
    if arguments:
        return pytest(arguments, environ)
    codes = [pytest([*SIDE_BY_SIDE, "tests"], environ), notebooks(environ)]
    if os.environ.get("CI"):  # takes minutes, and brings no news on a machine with a single Python
        codes.append(matrix.main([]))
    return next((code for code in codes if code), 0)


def pytest(arguments: list[str], environ: dict[str, str]) -> int:
    """Run pytest in a process of its own."""
    return subprocess.run([sys.executable, "-m", "pytest", *arguments], env=environ, check=False).returncode


def notebooks(environ: dict[str, str]) -> int:
    """Run nbval, strict, over the course: two notebooks at a time, each on a graph of its own.

    Prints what each has printed when it is done, and how long each took; the table is kept in artifacts/.
    """
    paths = sorted(path for path in Path("notebooks").rglob("*.ipynb") if ".ipynb_checkpoints" not in path.parts)
    with ThreadPoolExecutor(_NOTEBOOKS_AT_ONCE) as threads:
        ran = list(threads.map(lambda path: _notebook(path, environ), paths))
    rows = [
        f"| {path.as_posix()} | {seconds:.1f} s | {'passed' if code == 0 else 'FAILED'} |"
        for path, (code, seconds) in zip(paths, ran, strict=True)
    ]
    table = "\n".join(["| notebook | nbval | |", "|---|---|---|", *rows])
    print(f"\n{table}\n")
    Path("artifacts").mkdir(exist_ok=True)
    Path("artifacts/nbval_times.md").write_text(f"{table}\n", encoding="utf-8")
    return max((code for code, _ in ran), default=2)


def _notebook(path: Path, environ: dict[str, str]) -> tuple[int, float]:
    """Exit code and seconds of one notebook."""
    began = time.monotonic()
    with environment.exclusive_domain(_QUEUE_S) as domain_id:
        ran = subprocess.run(
            [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *NBVAL, str(path)],
            env={**environ, "ROS_DOMAIN_ID": str(domain_id)},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
    print(ran.stdout, flush=True)
    return ran.returncode, time.monotonic() - began


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

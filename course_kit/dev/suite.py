"""`./course test`: pytest on the tests and, by nbval, the notebooks, as much of them as somebody has time for.

`tests/sizes.py` has what is in `--quick` and `--all`. Other arguments go to pytest: `./course test tests/lab`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from course_kit import environment
from course_kit.text.console import refuse

# Tests wait for nodes twice as long as they compute. Files stay together, for their fixtures are dear, and begin in the
# order of `tests/sizes.py`, long ones early: xdist by itself begins those with few tests last, the longest among them.
SIDE_BY_SIDE = [
    *("-n", str(min(3 * len(os.sched_getaffinity(0)), 6))),
    *("--dist", "loadfile", "--no-loadscope-reorder"),
]
QUICK, ALL = "--quick", "--all"
MARKS = {QUICK: ["-m", "not weekly and not slow and not browser"], ALL: ["-m", ""]}
FIRST_LESSONS = "0[1-3]_*.ipynb"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def main(arguments: list[str]) -> int:
    """Run the suite and return its exit code: 0 when everything passed."""
    environment.heed_interrupts()
    root = environment.checkout_folder()
    if root is None:
        return refuse("the tests belong to the course's folder; run ./course test there.")
    os.chdir(root)
    size = next((option for option in (QUICK, ALL) if option in arguments), "")
    chosen = [argument for argument in arguments if argument not in (QUICK, ALL)]
    try:
        chromium = None if size == QUICK else find_or_install_browser()
        wanted = {"COURSE_KIT_PROGRESS": "off", "PYTHONDONTWRITEBYTECODE": None}  # thousands of Pythons are started
        environ = environment.child_environment(COURSE_BROWSER=chromium, **wanted)
        if not chosen:
            lessons = Path("notebooks").glob(FIRST_LESSONS) if size == QUICK else list_with_outputs(Path())
            chosen = [*SIDE_BY_SIDE, "--nbval", "tests", *sorted(map(str, lessons))]
        code = run_pytest([*MARKS.get(size, []), *chosen], environ)
        if size == ALL:
            code = _run_sessions("pythons", *(["hub"] if os.geteuid() == 0 else [])) or code
    except environment.DomainError as problem:
        return refuse(problem)
    except KeyboardInterrupt:  # pytest, which got it too, has said so
        return 130
    return code or 0


def list_with_outputs(course: Path, *, drills: bool = True) -> list[Path]:
    """The notebooks of a course whose outputs are stored: its lessons, demos and drills."""
    folders = ("notebooks", "exercises/drills") if drills else ("notebooks",)
    found = (path for folder in folders for path in (course / folder).rglob("*.ipynb"))
    return sorted(path for path in found if ".ipynb_checkpoints" not in path.parts)


def _run_sessions(*names: str) -> int:
    """Run sessions of `noxfile.py`; uv fetches nox."""
    uv = find_uv()
    if uv is None or not Path("noxfile.py").is_file():  # the student edition has none
        return 0
    return subprocess.run([uv, "tool", "run", "nox", "--sessions", *names], check=False).returncode


def find_uv() -> str | None:
    """The uv of this environment, or the one on PATH, or None."""
    return shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))


def find_browser() -> str | None:
    """The path of a Chromium on this machine, or None. COURSE_BROWSER wins."""
    names = (os.environ["COURSE_BROWSER"],) if os.environ.get("COURSE_BROWSER") else BROWSERS
    return next((path for name in names if (path := shutil.which(name))), None)


def find_or_install_browser() -> str | None:
    """Like `find_browser`, but a machine where we are root and apt-get is at hand gets Debian's Chromium first."""
    path = find_browser()
    if path or os.geteuid() != 0 or not shutil.which("apt-get"):
        return path
    print("course: installing Chromium for the browser tests (apt-get)", file=sys.stderr)
    environ = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (
        ["apt-get", "update", "-qq"],
        ["apt-get", "install", "-y", "-qq", "--no-install-recommends", "chromium"],
    ):
        done = subprocess.run(command, env=environ, stdout=subprocess.DEVNULL, check=False)
        if done.returncode:
            break
    return find_browser()


def run_pytest(arguments: list[str], environ: dict[str, str]) -> int:
    """Run pytest in a separate process."""
    return subprocess.run([sys.executable, "-m", "pytest", *arguments], env=environ, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

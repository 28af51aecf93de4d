"""Where things are kept: the checkout, what it generates, and what belongs to the user."""

from __future__ import annotations

import hashlib
import os
import site
import sys
import tempfile
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

import platformdirs

PACKAGE = Path(__file__).resolve().parent.parent
LEARNER_FOLDER = "my-course"  # in a clone: where a learner works; `course_kit.learner.workspace` makes it
MANIFEST = ".course.json"  # marks a learner's folder: what was handed out there
FOLDER_VARIABLE = "COURSE_KIT_FOLDER"  # the learner's folder that JupyterLab was opened on
PROGRESS_VARIABLE = "COURSE_KIT_PROGRESS"
COPIED = ("notebooks", "exercises")  # from the course into a learner's folder
CELL_PROGRAMS = "scripts"  # in `run_dir`, side by side: what cells have saved
_NAME = "ros2-course"
_APPLICATION = "ros2-course-kit"
_LOGS_KEPT = 40
_FILES = ("/.dockerenv", "/run/.containerenv", "/run/systemd/container")  # Docker, Podman, systemd-nspawn
_VARIABLES = ("container", "KUBERNETES_SERVICE_HOST")  # most engines set the first for all processes


def checkout_folder() -> Path | None:
    """The course folder this package runs from, or None where only the package is installed."""
    root = PACKAGE.parent
    return root if (root / "notebooks").is_dir() and (root / "pyproject.toml").is_file() else None


def course_files() -> Path | None:
    """The folder with the lessons and exercises: in a clone its own, of an installed package inside; None without."""
    packaged = PACKAGE / "course"
    return checkout_folder() or (packaged if (packaged / "notebooks").is_dir() else None)


def is_shared(root: Path) -> bool:
    """Whether this user cannot work in a course's folder."""
    return not all(is_writable(root / name, make=False) for name in COPIED if (root / name).is_dir())


def usual_learner_folder() -> Path:
    """Where a learner works: in the course's folder, or where that is shared in their home; it may not be there yet."""
    root = checkout_folder()
    if root is not None and not is_shared(root):
        return root / LEARNER_FOLDER
    found = home_folder()
    return state_dir() / _NAME if found is None else found / _NAME


def learner_folder() -> Path | None:
    """The learner's folder one is in, or that JupyterLab was opened on, or the usual one, or None."""
    places = [Path(chosen)] if (chosen := os.environ.get(FOLDER_VARIABLE, "")) else []
    with suppress(OSError):  # the working directory was removed
        here = Path.cwd()
        places = [here, *here.parents, *places]
    return next((place for place in (*places, usual_learner_folder()) if (place / MANIFEST).is_file()), None)


def lesson_path(notebook: str, base: Path | None = None) -> Path | None:
    """A notebook of the course, None where it is not here."""
    root = course_files()
    folders = [*([base, *base.parents] if base else []), *([root] if root else [])]
    return next((folder / notebook for folder in folders if (folder / notebook).is_file()), None)


def course_command() -> str:
    """How the user calls the course from where they are: `./course` where that stands, `course-kit` elsewhere."""
    root = checkout_folder()
    try:
        if root is None:
            return "./course" if Path(MANIFEST).is_file() and Path("course").is_file() else "course-kit"
        return "./course" if (root / "course").samefile("course") else "course-kit"
    except OSError:  # none stands here, or the working directory was removed
        return "course-kit"


def home_folder() -> Path | None:
    """The user's home directory; None if it cannot be written."""
    try:
        found = Path.home()
    except RuntimeError:  # HOME is not set, and the system does not know this user, as in some containers
        return None
    return found if found.is_absolute() and is_writable(found, make=False) else None


def state_dir() -> Path:
    """The user's state directory for the course (XDG_STATE_HOME); a temporary one where there is no usable home."""
    return _state_dir(os.environ.get("XDG_STATE_HOME"), os.environ.get("HOME"))


def usual_state_dir() -> Path | None:
    """Where that directory is when it can be made; None where nobody knows the user's home directory."""
    try:
        found = platformdirs.user_state_path(_APPLICATION, appauthor=False)
    except RuntimeError:
        return None
    return found if found.is_absolute() else None  # in older versions of platformdirs it begins with a ~


@lru_cache(maxsize=8)
def _state_dir(xdg: str | None, home: str | None) -> Path:  # noqa: ARG001 - the cache is keyed by both
    wanted = usual_state_dir()
    if wanted is not None and is_writable(wanted):
        return wanted
    spare = Path(tempfile.gettempdir()) / f"{_APPLICATION}-{os.getuid()}"
    if is_writable(spare) and spare.stat().st_uid == os.getuid():
        return spare
    return Path(tempfile.mkdtemp(prefix=f"{_APPLICATION}-"))


def run_dir(part: str = "") -> Path:
    """This checkout's folder for generated things, or one in it; beside the course when that is writable."""
    root, folder = checkout_folder(), state_dir() / "run"
    if root is not None and is_writable(root / ".course"):
        folder = root / ".course"
    (folder / part).mkdir(parents=True, exist_ok=True)
    return folder / part


def own_run_dir() -> Path:
    """Where progress is kept: in the learner's folder one is in, in its clone, or elsewhere for this course alone."""
    root, mine = checkout_folder(), learner_folder()
    if mine is not None and (root is None or root not in mine.parents) and is_writable(mine / ".course"):
        return mine / ".course"
    folder = run_dir()
    if root is None or folder.is_relative_to(root):
        return folder
    elsewhere = folder / hashlib.sha256(os.fsencode(root)).hexdigest()[:16]
    elsewhere.mkdir(exist_ok=True)
    return elsewhere


def progress_file() -> Path | None:
    """Where what was reached is kept; None where nothing is, as for the tests: COURSE_KIT_PROGRESS is `off`."""
    chosen = os.environ.get(PROGRESS_VARIABLE, "")
    if chosen == "off":
        return None
    return Path(chosen) if chosen else own_run_dir() / "progress.json"


def guess_folder() -> Path | None:
    """Where a learner's guesses are kept, beside their progress; None where nothing is."""
    try:
        beside = progress_file()
    except OSError:
        return None
    return None if beside is None else beside.parent / "guesses"


def is_writable(folder: Path, *, make: bool = True) -> bool:
    """Whether this user can make files in a folder."""
    try:
        if make:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK, effective_ids=True)


def has_chosen_logs() -> bool:
    """Whether the user has chosen one that can be written, by themselves: without any, ROS does not start."""
    home = os.environ.get("ROS_HOME", "")
    chosen = os.environ.get("ROS_LOG_DIR") or (f"{home}/log" if home else "")
    return bool(chosen) and is_writable(Path(os.path.expanduser(chosen)))  # noqa: PTH111 - unlike Path's, never raises


def make_log_folder() -> Path:
    """Where ROS writes a file per process; the oldest are removed so that the folder does not grow for ever."""
    folder = state_dir() / "log"
    folder.mkdir(parents=True, exist_ok=True)
    with os.scandir(folder) as entries:
        files = [entry for entry in entries if entry.name.endswith(".log")]
    if len(files) > 2 * _LOGS_KEPT:
        with suppress(FileNotFoundError):  # another process has just removed one
            for old in sorted(files, key=lambda entry: entry.stat().st_mtime)[:-_LOGS_KEPT]:
                Path(old.path).unlink()
    return folder


def scripts_folder() -> Path:
    """Where the installer has put `ros2` and `course-kit`: beside Python, or with `pip install --user` at home."""
    beside = Path(sys.prefix) / "bin"
    at_home = Path(site.getuserbase()) / "bin"
    return at_home if (at_home / "ros2").is_file() and not (beside / "ros2").is_file() else beside


def with_scripts_first(path: str | None) -> str:
    """A value for PATH that begins with that folder; the course's own `ros2` steps aside for a real one behind it."""
    first = str(scripts_folder())
    folders = (path or os.defpath).split(os.pathsep)
    return os.pathsep.join([first, *(folder for folder in folders if folder != first)])


def put_scripts_first() -> None:
    """Have this process, and all that it starts, find those programs first."""
    os.environ["PATH"] = with_scripts_first(os.environ.get("PATH"))


def sign_of_container() -> str:
    """What shows that this is a container, for people: `/.dockerenv`; empty where nothing does."""
    signs = [name for name in _FILES if Path(name).exists()]
    signs += [f"the variable {name}" for name in _VARIABLES if os.environ.get(name)]
    return next(iter(signs), "")

"""Makes a Python environment and installs the course into it, with uv or with Python's own venv and pip."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_setup import locked_packages
from course_setup.portable import PROMPT, make_portable
from course_setup.problems import SetUpError, unfinished

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_setup.environments import Environment

_OLDEST_PIP = 22  # older ones cannot install a course from its folder so that edits count at once
_ONLINE = "It needs a network connection."
# What the user has set for other installations would lead this one astray.
_NOT_PASSED_ON = {
    "PYTHONPATH",
    "PYTHONHOME",
    "VIRTUAL_ENV",
    "PIP_TARGET",
    "PIP_PREFIX",
    "PIP_ROOT",
    "PIP_CONSTRAINT",
    "UV_TARGET",
    "UV_PREFIX",
    "UV_CONSTRAINT",
    "UV_OVERRIDE",
}


@dataclass(frozen=True)
class Installer:
    """How environments of one course folder are made."""

    root: Path
    python: str
    uv: str  # the uv to use, or "" for venv and pip
    kind: str  # "jazzy": the sourced ROS 2 brings rclpy, and the numpy it was compiled for; or "wheels"
    unlocked: bool = False  # resolve afresh instead of installing the packages of the lock
    find_links: str = ""  # the folder to install from, without the network, or ""

    @property
    def system_ros(self) -> bool:
        """Whether the environment uses the packages of a ROS 2 outside of it."""
        return self.kind == "jazzy"

    def create(self, environment: Environment) -> None:
        """Make an empty environment.

        Raises:
            SetUpError: this Python cannot, or uv could not.
        """
        python = os.path.realpath(self.python)  # /usr/bin/python3 is another one after the next release upgrade
        if self.uv:
            command = [self.uv, "venv", "--quiet", "--prompt", PROMPT, "--python", python]
        else:
            self._require_venv()
            command = [
                python,
                "-m",
                "venv",
                "--prompt",
                PROMPT,
                *(["--system-site-packages"] if self.system_ros else []),
            ]
        failed = ("the Python environment could not be made", _ONLINE)
        self._run([*command, str(environment.path)], environment, failed)

    def install(self, environment: Environment, *, with_tests: bool) -> None:
        """Install the course, and ROS 2 where there is none, or bring what is there up to date.

        Raises:
            SetUpError: the installer could not; it has said why.
        """
        extras = [] if self.system_ros else ["ros"]
        if with_tests:
            extras += ["test"] if self.system_ros else ["test-ros", "test"]
        if self.unlocked:
            self._install_newest(environment, extras)
        else:
            self._install_locked(environment, extras)
        self._mend_overwritten(environment)
        self._compile(environment)
        if with_tests:
            _hide_test_tools(environment)
        make_portable(environment.path)

    def _install_locked(self, environment: Environment, extras: Sequence[str]) -> None:
        numpy = locked_packages.numpy_beside(self._numpy_of_ros()) if self.system_ros else "numpy"
        if not self.uv:
            self._install(environment, locked_packages.pip())  # which knows --build-constraint
        tools = ["--build-constraints" if self.uv else "--build-constraint", locked_packages.build_tools()]
        self._install(environment, [*tools, *locked_packages.packages(extras, numpy)])
        # By itself, because the course has no hash, and who asks for hashes asks for all.
        self._install(environment, [*tools, "--no-deps", *_course(extras)])

    def _install_newest(self, environment: Environment, extras: Sequence[str]) -> None:
        wanted = _course(extras)
        if self.system_ros and (self._numpy_of_ros() or (1,)) < (2,):
            wanted.append("numpy<2")
        if self.uv:
            wanted.insert(0, "pip")  # for the user; environments of uv come without
        self._require_new_pip(environment)
        self._install(environment, wanted)

    def _numpy_of_ros(self) -> tuple[int, ...] | None:
        return locked_packages.version_of_numpy(self.python)

    def _require_venv(self) -> None:
        asked = subprocess.run([self.python, "-I", "-c", "import ensurepip, venv"], capture_output=True, check=False)
        if asked.returncode:
            raise SetUpError(
                f"This Python ({self.python}) comes without 'venv'. Debian, Ubuntu: sudo apt install python3-venv. Or "
                "install uv (https://docs.astral.sh/uv/). Then run this again."
            )

    def _require_new_pip(self, environment: Environment) -> None:
        for found in environment.path.glob("lib/python3*/site-packages/pip-*.dist-info"):
            version = re.match(r"pip-(\d+)", found.name)
            if version and int(version[1]) < _OLDEST_PIP and not self.uv:
                self._install(environment, ["--upgrade", f"pip>={_OLDEST_PIP}"])

    def _mend_overwritten(self, environment: Environment) -> None:
        """Install packages again whose files another one has overwritten; which they are, the kit knows."""
        question = self.root / "course_kit" / "environment" / "packages.py"
        if question.exists():
            asked = subprocess.run([environment.python, "-I", question], stdout=subprocess.PIPE, text=True, check=False)
            for package in asked.stdout.split():
                self._install(environment, ["--force-reinstall", "--no-deps", package])

    def _compile(self, environment: Environment) -> None:
        """Have Python compile the course once; else each command does it where Python may not keep what it compiles."""
        folder = self.root / "course_kit"
        if folder.is_dir():
            command = [str(environment.python), "-I", "-m", "compileall", "-q", str(folder)]
            subprocess.run(command, cwd=self.root, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)

    def _install(self, environment: Environment, wanted: Sequence[str]) -> None:
        if self.uv:
            command = [self.uv, "pip", "install", "--python", str(environment.python)]
        else:
            command = [str(environment.python), "-m", "pip", "install", "--disable-pip-version-check"]
            command += [
                "--quiet",
                "--quiet",
                "--progress-bar",
                "off",
            ]  # not even its warnings
        if self.find_links:
            command += ["--no-index", "--find-links", self.find_links]
        self._run([*command, *wanted], environment, ("the installation did not finish", self._source()))

    def _run(self, command: list[str], environment: Environment, failed: tuple[str, str]) -> None:
        # Temporary files beside the environment: /tmp may be small, or let no compiler run.
        work = environment.path.with_name(f"{environment.path.name}.work")
        work.mkdir(exist_ok=True)
        try:
            done = subprocess.run(command, cwd=self.root, env=self._variables(work), stdout=sys.stderr, check=False)
        finally:
            shutil.rmtree(work, ignore_errors=True)
        if done.returncode:
            raise SetUpError(unfinished(*failed, self.root, self.kind))

    def _source(self) -> str:
        """Where an installation gets its packages, as a sentence for when it did not work."""
        if self.find_links:
            return (
                f"Everything has to be in {self.find_links}, for this Python. An instructor's copy of the course makes "
                "such a folder: ./course bundle DIR."
            )
        if self.unlocked:
            return _ONLINE
        return f"{_ONLINE} If a version is missing or a hash differs, COURSE_UNLOCKED=1 installs the newest packages."

    def _variables(self, work: Path) -> dict[str, str]:
        kept = {name: value for name, value in os.environ.items() if name not in _NOT_PASSED_ON}
        # In a locale of another encoding uv would install into a folder whose name it got wrong. The user's own
        # packages, outside of the environment, may be gone tomorrow.
        changed = {
            "LC_ALL": "C.UTF-8",
            "PYTHONUTF8": "1",
            "PYTHONNOUSERSITE": "1",
            "PIP_USER": "0",
            "TMPDIR": str(work),
            "UV_COMPILE_BYTECODE": "1",  # as pip does: see _compile
        }
        if self.uv and not _can_write(_cache_of_uv()):
            changed["UV_NO_CACHE"] = "1"  # pip does without by itself
        return {**kept, **changed}


def _course(extras: Sequence[str]) -> list[str]:
    # Installers are run in the course's folder: its name may hold what they would take for something else.
    return ["-e", f".[{','.join(extras)}]" if extras else "."]


def _cache_of_uv() -> Path:
    if os.environ.get("UV_CACHE_DIR"):
        return Path(os.environ["UV_CACHE_DIR"])
    shared = Path(os.environ.get("XDG_CACHE_HOME", ""))
    home = os.path.expanduser("~")  # noqa: PTH111 - pathlib's raises an error where there is no home
    return (shared if shared.is_absolute() else Path(home, ".cache")) / "uv"


def _can_write(folder: Path) -> bool:
    if not folder.is_absolute():  # nobody's home
        return False
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    return os.access(existing, os.W_OK | os.X_OK)


def _hide_test_tools(environment: Environment) -> None:
    """Keep nbgrader's buttons, which come with the test tools, out of a learner's way.

    `jupyter labextension enable` shows them.
    """
    page = environment.path / "etc" / "jupyter" / "labconfig" / "page_config.json"
    page.parent.mkdir(parents=True, exist_ok=True)
    if not page.exists():
        page.write_text('{"disabledExtensions": {"@jupyter/nbgrader": true}}\n')

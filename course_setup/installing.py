"""Makes a Python environment and installs the course into it, with uv.

What is installed is locked: for each package its version and the hashes of its files. `course-kit dev lock` writes the
lock, as requirement files with hashes, one for each extra in pyproject.toml. They name no server, so that an
installation through a school's own mirror finds everything; pylock.toml (PEP 751) and uv.lock write down URLs.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_setup.problems import SetUpError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_setup.environments import Environment
    from course_setup.main import Request

_LOCKED = Path("course_setup", "locked")
_BUILD_TOOLS = ["--build-constraints", str(_LOCKED / "build.txt")]
_OLDEST_NUMPY = (1, 26)  # pyproject.toml asks for it
_ONLINE = "It needs a network connection."
_NO_UV = "Where there is no uv for a machine, use a container of x86-64 Linux."
# What the user has set for other installations would lead this one astray.
_NOT_PASSED_ON = re.compile(
    "PYTHON(PATH|HOME)|VIRTUAL_ENV|PIP_(TARGET|PREFIX|ROOT|CONSTRAINT)|UV_(TARGET|PREFIX|CONSTRAINT|OVERRIDE)"
)
# The pip that Python has in store for new environments, without making one, which would take seconds more.
_NO_PIP = 99
_PIP = f"""
import pathlib, runpy, sys, sysconfig
try:
    import ensurepip
except ImportError:
    sys.exit({_NO_PIP})
folders = [sysconfig.get_config_var("WHEEL_PKG_DIR") or "", pathlib.Path(ensurepip.__file__).with_name("_bundled")]
wheels = [wheel for folder in folders if folder for wheel in pathlib.Path(folder).glob("pip-*.whl")]
sys.path.insert(0, str(wheels[0]))
runpy.run_module("pip", run_name="__main__", alter_sys=True)
"""
# The course's folder is that of `.venvs`, whatever letters its name has; Python reads this file at each start.
_WAY_TO_THE_COURSE = (
    b"import os, sys; sys.path.append(os.path.dirname(os.path.dirname(os.path.realpath(sys.prefix))))\n"
)
# Nothing is loaded from the folder that one is in, where strangers' programs may lie.
_VERSION_OF_NUMPY = (
    "import sys; sys.path[:] = filter(None, sys.path); import numpy; print(*numpy.__version__.split('.')[:2])"
)


@dataclass(frozen=True)
class Installer:
    """How environments of one course folder are made."""

    request: Request
    root: Path

    @property
    def uv(self) -> Path:
        """Where uv is, or will be once `get_uv` has been called."""
        locked = (self.root / _LOCKED / "uv.txt").read_text("utf-8")
        version = re.search(r"^uv==(\S+)", locked, re.MULTILINE)
        return Path(self.request.uv or self.root / ".venvs" / f"uv-{version and version[1]}" / "uv")

    def get_uv(self) -> None:
        """Download uv where this machine has none."""
        if not self.uv.exists():
            with tempfile.TemporaryDirectory(prefix="uv-", dir=self.root / ".venvs") as work:
                self._download_uv(Path(work, "packages"))

    def _download_uv(self, packages: Path) -> None:
        options = ["-qq", "--disable-pip-version-check", "--no-compile", "--only-binary=:all:", *self._offline()]
        wanted = ["--target", str(packages), "--no-deps", "--require-hashes", "-r", str(_LOCKED / "uv.txt")]
        done = self._run([self.request.python, "-I", "-c", _PIP, "install", *options, *wanted], packages)
        if done.returncode == _NO_PIP:
            raise SetUpError(
                f"This Python ({self.request.python}) comes without 'venv'. Debian, Ubuntu: sudo apt install "
                "python3-venv. Or install uv (https://docs.astral.sh/uv/). Then run this again."
            )
        self._require(done, "uv, which installs the course, could not be downloaded", f"{self._source()} {_NO_UV}")
        program = packages / "bin" / "uv"
        try:
            subprocess.run([program, "--version"], capture_output=True, check=True)
        except (OSError, subprocess.CalledProcessError) as problem:
            raise SetUpError(f"uv, which installs the course, does not run here ({problem}). {_NO_UV}") from None
        self.uv.parent.mkdir(exist_ok=True)
        program.replace(self.uv)

    def create(self, environment: Environment) -> None:
        """Make an empty environment."""
        python = os.path.realpath(self.request.python)  # /usr/bin/python3 changes with the next release upgrade
        options = ["--quiet", "--prompt", "course", "--python", python]
        if self.request.system_ros:
            options.append("--system-site-packages")
        done = self._run([str(self.uv), "venv", *options, str(environment.path)], environment.path)
        self._require(done, "the Python environment could not be made", _ONLINE)

    def install(self, environment: Environment, *, with_tests: bool) -> None:
        """Install the course, and ROS 2 if it is missing."""
        extras = [] if self.request.system_ros else ["ros"]
        if with_tests:
            extras += ["test"] if self.request.system_ros else ["test-ros", "test"]
        course = ["-e", f".[{','.join(extras)}]" if extras else "."]  # in its folder, whose name may be an odd one
        numpy = self._version_of_numpy() if self.request.system_ros else None
        if self.request.unlocked:
            of_ros = f"numpy=={numpy[0]}.{numpy[1]}.*" if numpy and numpy >= _OLDEST_NUMPY else "numpy<2"
            self._install(environment, ["pip", *course, *([of_ros] if self.request.system_ros else [])])
            self._compile(environment).wait()
        else:
            # The messages of a sourced ROS 2 are compiled for its numpy, or for numpy 1.
            beside_ros = [] if numpy and numpy >= _OLDEST_NUMPY else ["numpy-1"]
            files = ["pip", "course", *(beside_ros if self.request.system_ros else ["numpy"]), *extras]
            words = [word for name in files for word in ("-r", str(_LOCKED / f"{name}.txt"))]
            self._install(environment, [*_BUILD_TOOLS, "--no-deps", "--require-hashes", *words])
            with self._compile(environment):
                # By itself, because the course has no hash, and who asks for hashes asks for all.
                self._install(environment, [*_BUILD_TOOLS, "--no-deps", *course])
        for way in environment.path.glob("lib/python3*/site-packages/*ros2_course_kit.pth"):
            way.unlink()  # uv keeps the same file in its cache
            way.write_bytes(_WAY_TO_THE_COURSE)

    def _version_of_numpy(self) -> tuple[int, ...]:
        command = [self.request.python, "-c", _VERSION_OF_NUMPY]
        asked = subprocess.run(command, capture_output=True, text=True, check=False)
        return tuple(map(int, asked.stdout.split())) if asked.returncode == 0 else ()

    def _compile(self, environment: Environment) -> subprocess.Popen[bytes]:
        """Have Python compile what gradings load: they may not keep what they compile themselves."""
        site, *_ = environment.path.glob("lib/python3*/site-packages")
        records = [record for name in ("ros_", "numpy-", "lark-") for record in site.glob(f"{name}*.dist-info/RECORD")]
        names = [line.split(",")[0] for record in records for line in record.read_text("utf-8").splitlines()]
        files = [str(site / name) for name in names if name.endswith(".py") and "/tests/" not in name]
        files += map(str, (self.root / "course_kit").rglob("*.py"))
        listed = environment.path / "compiled.txt"
        listed.write_text("\n".join(files), "utf-8", "surrogateescape")
        command = [str(environment.python), "-I", "-X", "utf8", "-m", "compileall", "-q", "-i", str(listed)]
        return subprocess.Popen([*command, "-x", "/templates/"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def _install(self, environment: Environment, wanted: Sequence[str]) -> None:
        command = [str(self.uv), "pip", "install", "--python", str(environment.python), "--quiet", *self._offline()]
        self._require(
            self._run([*command, *wanted], environment.path), "the installation did not finish", self._source()
        )

    def _offline(self) -> list[str]:
        return ["--no-index", "--find-links", self.request.find_links] if self.request.find_links else []

    def _run(self, command: list[str], place: Path) -> subprocess.CompletedProcess[str]:
        # Temporary files beside the environment: /tmp may be small, or let no compiler run.
        with tempfile.TemporaryDirectory(prefix=f"{place.name}.work-", dir=place.parent) as work:
            return subprocess.run(
                command,
                cwd=self.root,
                env=_variables(work),
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                encoding="utf-8",
                errors="replace",
                check=False,
            )

    def _require(self, done: subprocess.CompletedProcess[str], failed: str, source: str) -> None:
        if done.returncode:
            sys.stderr.write(done.stdout)
            raise SetUpError(f"{failed}; the lines above say why. {source} Then run the same command again.")

    def _source(self) -> str:
        """Where an installation gets its packages, as a sentence for when it did not work."""
        if self.request.find_links:
            return (
                f"Everything has to be in {self.request.find_links}, for this Python. An instructor's copy of the "
                "course makes such a folder: ./course bundle DIR."
            )
        if self.request.unlocked:
            return _ONLINE
        return f"{_ONLINE} If a version is missing or a hash differs, COURSE_UNLOCKED=1 installs the newest packages."


def _variables(work: str) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not _NOT_PASSED_ON.fullmatch(name)}
    # In a locale of another encoding uv would install into a folder whose name it got wrong. The user's own packages,
    # outside of the environment, may be gone tomorrow.
    kept.update(LC_ALL="C.UTF-8", PYTHONUTF8="1", PYTHONNOUSERSITE="1", PIP_USER="0", TMPDIR=work)
    home = os.path.expanduser("~")  # noqa: PTH111 - pathlib's raises an error where there is no home
    if not kept.get("UV_CACHE_DIR") and not kept.get("XDG_CACHE_HOME") and not os.access(home, os.W_OK | os.X_OK):
        kept["UV_NO_CACHE"] = "1"
    return kept

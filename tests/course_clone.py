"""A fresh clone of the course with stand-ins for the tools of its set-up: tests must pass without a network."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

REPOSITORY = Path(__file__).resolve().parent.parent
BASE_PYTHON = Path(sys.executable).resolve()  # without the packages of the kit

STAND_IN_UV = r"""#!/bin/sh
# Stands in for uv: makes a real venv without pip, and instead of installing notes what it was asked for. As the real
# one does, it writes down where the course is.
echo "$@" >>"$STAND_IN_LOG"
env >"$STAND_IN_LOG.variables"
case $1 in
  run) echo "$STAND_IN_PYTHON" ;;
  venv) for last; do :; done; exec "$STAND_IN_PYTHON" -m venv --without-pip --prompt course "$last" ;;
  pip) case "$*" in *"--no-deps -e "*) STAND_IN_PIPE='' ;; esac # it waits before it installs the packages of the lock
       if [ -n "${STAND_IN_PIPE:-}" ]; then echo blocked >"$STAND_IN_PIPE"; read -r _ <"$STAND_IN_PIPE"; fi
       if [ -n "${STAND_IN_RESULT:-}" ]; then exit "$STAND_IN_RESULT"; fi
       environment=${4%/bin/python}
       rm -f "$environment"/lib/python3*/site-packages/*.pth "$environment/bin/program"
       for packages in "$environment"/lib/python3*/site-packages; do
         pwd >"$packages/_editable_impl_ros2_course_kit.pth"
       done
       cat >"$environment/bin/program" <<END
#!/bin/sh
'''exec' "\$(dirname "\$(realpath "\$0")")/python" "\$0" "\$@"
' '''
import sys; print("program", sys.prefix)
END
       chmod +x "$environment/bin/program" ;;
esac
"""
# Stands in for the Python of a sourced ROS 2 Jazzy: has rclpy. STAND_IN_NUMPY is the version of its numpy, such as
# "1 26"; it has none by itself.
STAND_IN_ROS_PYTHON = f"""#!/bin/sh
case "$*" in
  "-c "*"import rclpy") exit 0 ;;
  "-c "*"import numpy"*) if [ -n "${{STAND_IN_NUMPY:-}}" ]; then echo "$STAND_IN_NUMPY"; else exit 1; fi ;;
  *) exec {BASE_PYTHON} "$@" ;;
esac
"""
STAND_IN_CLI = "import os, sys; print('cli', os.environ['VIRTUAL_ENV'], *sys.argv[1:])\n"


def hear_ctrl_c() -> None:
    """Make a process sensitive to Ctrl-C, which shells switch off in what they start in the background."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


class Clone:
    """A fresh clone in a folder with a space, with the tools its script finds on PATH."""

    def __init__(self, folder: Path, name: str = "my course") -> None:
        self.root = folder / name
        self.tools = folder / "tools"
        self.log = folder / "log"
        self.tools.mkdir()
        generated = shutil.ignore_patterns("__pycache__", "*.so", "*.tmp")
        for part in ("course_setup", "course_kit/interfaces/native", "course_kit/jupyter_config"):
            shutil.copytree(REPOSITORY / part, self.root / part, ignore=generated)
        for part in ("course", "pyproject.toml", "hatch_build.py", "course_kit/course_kit.pth"):
            shutil.copy(REPOSITORY / part, self.root / part)
        (self.root / "course_kit/__init__.py").touch()  # to compile all of the kit takes longer than everything else
        for module in ("cli/main.py", "dev/suite.py"):
            (self.root / "course_kit" / module).parent.mkdir()
            (self.root / "course_kit" / module).write_text(STAND_IN_CLI)
        self.tool("uv", STAND_IN_UV)
        self.log.touch()

    def tool(self, name: str, text: str) -> None:
        (self.tools / name).write_text(text)
        (self.tools / name).chmod(0o755)

    def environ(self, **variables: str) -> dict[str, str]:
        kept = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("ROS", "PYTHON", "COURSE", "VIRTUAL"))
        }

        return {
            **kept,
            "PATH": f"{self.tools}:/usr/bin:/bin",
            "COURSE_PYTHON": str(BASE_PYTHON),
            "STAND_IN_PYTHON": str(BASE_PYTHON),
            "STAND_IN_LOG": str(self.log),
            **variables,
        }

    def course(
        self,
        *arguments: str,
        cwd: Path | None = None,
        before: Callable[[], None] | None = None,
        **variables: str,
    ) -> subprocess.CompletedProcess[str]:
        """Run `./course`, after `before` has been called in its process."""
        return subprocess.run(
            [self.root / "course", *arguments],
            cwd=cwd or self.root,
            preexec_fn=before,
            env=self.environ(**variables),
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    def sourced(self) -> dict[str, str]:
        """The variables of a terminal in which a ROS 2 Jazzy is sourced."""
        self.tool("ros_python", STAND_IN_ROS_PYTHON)
        return {"ROS_DISTRO": "jazzy", "COURSE_PYTHON": str(self.tools / "ros_python")}

    def half_way(self, folder: Path, *arguments: str) -> subprocess.Popen[str]:
        """A set-up in which the installation has begun, and waits."""
        pipe = folder / "pipe"
        os.mkfifo(pipe)
        started = subprocess.Popen(
            [self.root / "course", *(arguments or ("doctor",))],
            cwd=self.root,
            env=self.environ(STAND_IN_PIPE=str(pipe)),
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            preexec_fn=hear_ctrl_c,  # noqa: PLW1509 - it only sets a signal
        )
        assert pipe.read_text() == "blocked\n"
        return started

    def calls(self) -> list[str]:
        """The installers' calls; of a locked installation that for its packages, not those for pip and the course."""
        lines = [
            line for line in self.log.read_text().splitlines() if not line.endswith("-r course_setup/locked/pip.txt")
        ]
        return [line.split()[0] for line in lines if not {"--no-deps", "-e"} <= set(line.split())]

    @property
    def environment(self) -> Path:
        """The environment that `.venv` leads to."""
        return (self.root / ".venv").resolve(strict=True)

    def environments(self) -> set[Path]:
        """All environments there are."""
        return {path for path in (self.root / ".venvs").iterdir() if path.is_dir() and not path.is_symlink()}

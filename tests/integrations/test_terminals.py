"""`ros2` in the terminals of a JupyterLab that the course has not started, and of `course-kit lab`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.integrations import server_extension
from tests.jupyter_server import allow_root, started

if TYPE_CHECKING:
    from collections.abc import Iterator

SCRIPTS = Path(sys.executable).parent.resolve()  # .venv is a link
SYSTEM_PATH = "/usr/local/bin:/usr/bin:/bin"
# What a hub's terminal reads first; like Debian's /etc/profile it forgets the PATH there was.
PROFILE = f"export PATH={SYSTEM_PATH} READ_AT_LOGIN=yes\n"


@pytest.fixture
def home(tmp_path: Path) -> Path:
    made = tmp_path / "home"
    made.mkdir()
    (made / ".bash_profile").write_text(PROFILE)
    return made


@pytest.fixture
def variables(home: Path) -> Iterator[dict[str, str | None]]:
    """An environment in which nobody has put the course's programs on PATH."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("COURSE_KIT", "JUPYTER"))}
    with environment.exclusive_domain() as domain_id:
        yield {
            **kept,
            "HOME": str(home),
            "PATH": SYSTEM_PATH,
            "ROS_DOMAIN_ID": str(domain_id),
            "SHELL": "/bin/bash",
            "VIRTUAL_ENV": None,
            "XDG_STATE_HOME": None,
        }


def test_a_server_that_somebody_else_starts_has_ros2_in_its_terminals(
    tmp_path: Path, home: Path, variables: dict[str, str | None]
) -> None:
    as_root = ["--allow-root"] if os.geteuid() == 0 else []
    with started([SCRIPTS / "jupyter", "lab", *as_root], tmp_path, home, variables) as server:
        shown = server.in_terminal(
            "command -v ros2 python; ros2 interface show std_srvs/srv/Trigger; echo $READ_AT_LOGIN"
        )
        completed = server.in_terminal("complete -p ros2")
    assert shown.splitlines()[:2] == [str(SCRIPTS / "ros2"), str(SCRIPTS / "python")]
    assert "bool success" in shown
    assert shown.splitlines()[-1] == "yes"  # the user's own set-up was read, too
    assert "_python_argcomplete" in completed


def test_course_kit_lab_without_the_door_has_it_too_also_with_a_middleware_that_is_not_installed(
    tmp_path: Path, variables: dict[str, str | None]
) -> None:
    changes = {"RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp"}
    command = [SCRIPTS / "course-kit", "lab", *allow_root()]
    folder = tmp_path / "mine"
    command.insert(2, folder)
    environ = {**variables, **changes}
    with started(command, tmp_path, tmp_path, environ) as server:
        # The launcher starts it where the file browser is.
        again = f"cd notebooks; . '{server_extension.START_FILE}'; pwd"
        placed = server.in_terminal(f"pwd; {again}; course --help | head -n 1; ./course --help | head -n 1")
        kept = {name: value for name, value in environ.items() if value is not None}
        once_more = [SCRIPTS / "course-kit", "lab", folder, "--no-browser"]
        second = subprocess.run(
            once_more, env=kept, cwd=tmp_path, capture_output=True, text=True, timeout=100, check=False
        )
        shown = server.in_terminal(
            "command -v ros2; ros2 service list; python -c 'import rclpy; rclpy.init()' && echo up"
        )
        told = [line for line in server.log.read_text().splitlines() if "rmw_cyclonedds_cpp" in line]
    assert shown.splitlines() == [str(SCRIPTS / "ros2"), "up"]
    assert placed.splitlines()[:2] == [str(folder)] * 2
    assert placed.splitlines()[2] == placed.splitlines()[3]
    assert "JupyterLab is already running for" in second.stdout
    assert f":{server.address.rpartition(':')[2]}/lab?token={server.token}" in second.stdout
    assert len(told) == 1
    assert "the course uses rmw_fastrtps_cpp" in told[0]


def test_bash_is_for_those_who_have_no_other_favourite_and_for_the_courses_own_server() -> None:
    found = [server_extension.prefers_bash({"SHELL": shell}) for shell in ("", "/usr/bin/bash", "/usr/bin/fish")]
    assert found == [True, True, False]
    assert server_extension.prefers_bash({"SHELL": "/bin/zsh", environment.paths.FOLDER_VARIABLE: "my-course"})

"""A machine with a JupyterHub: accounts for users, the course installed once, the hub with its proxy."""

from __future__ import annotations

import os
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import urllib.request
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil

from course_kit import environment
from course_kit.authoring import edition_plan
from course_kit.ros2cli import cli
from tests.hub import guide
from tests.jupyter_server import wait_until_up
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

PASSWORD = "only for this test"  # noqa: S105 - of users who live as long as it
_BEGIN = "course-hub-"  # of the names of the users
_INSTALL_S, _DOWN_S = 900.0, 60.0
_OURS = ("COURSE", "ROS", "_ROS", "RMW", "FAST", "PYTEST", "PYTHON", "JUPYTER", "VIRTUAL", "XDG", "IPYTHON")


@dataclass(frozen=True)
class Account:
    """A Unix user with a home directory."""

    name: str
    home: Path

    def processes(self) -> list[psutil.Process]:
        """What runs as this user."""
        number = pwd.getpwnam(self.name).pw_uid
        found = []
        for process in psutil.process_iter():
            with suppress(psutil.NoSuchProcess):
                if process.uids().real == number and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(process)
        return found

    def disk_kb(self) -> int:
        """What the home directory takes."""
        inodes = [self.home, *self.home.rglob("*")]
        return sum(path.lstat().st_blocks for path in inodes) // 2

    def memory_mb(self) -> float:
        """What the processes take, memory that several share counted once for all."""
        total = 0
        for process in self.processes():
            with suppress(psutil.NoSuchProcess):
                total += process.memory_full_info().pss
        return total / 2**20


@contextmanager
def accounts(folder: Path, count: int) -> Iterator[list[Account]]:
    """Users of this machine, with homes in a folder; they are removed afterwards, with what they left running."""
    made: list[Account] = []
    try:
        for number in range(1, count + 1):
            account = Account(f"{_BEGIN}{number}", folder / f"{_BEGIN}{number}")
            _remove(account)  # left by a run that was killed
            command = ["useradd", "--create-home", "--home-dir", str(account.home), "--shell", "/bin/bash"]
            subprocess.run([*command, account.name], check=True, capture_output=True)
            made.append(account)
        yield made
    finally:
        for account in made:
            for process in account.processes():
                with suppress(psutil.NoSuchProcess):
                    process.kill()
            wait_until(lambda account=account: not account.processes(), f"the end of what {account.name} ran")  # type: ignore[misc]
            _remove(account)


def _remove(account: Account) -> None:
    with suppress(KeyError):
        pwd.getpwnam(account.name)
        subprocess.run(["userdel", account.name], check=True, capture_output=True)


def clean_environment(folder: Path) -> dict[str, str]:
    """The environment of an administrator who has only just come to this machine."""
    environ = cli.clean_environment({**os.environ})
    kept = {name: value for name, value in environ.items() if not name.startswith(_OURS)}
    tools = folder / "tools"  # of the programs beside the tests' own Python only uv
    if not tools.is_dir() and (uv := shutil.which("uv", path=str(Path(sys.executable).parent))):
        tools.mkdir()
        (tools / "uv").symlink_to(uv)
    ours = str(Path(sys.executable).parent)
    path = [str(tools), *(one for one in kept["PATH"].split(os.pathsep) if one != ours)]
    return {**kept, "PATH": os.pathsep.join(path)}


def install(folder: Path) -> Path:
    """Install the course as the guide says, below a folder instead of `/opt`; returns the course's folder."""
    root = environment.checkout_folder()
    assert root is not None
    course = Path(guide.moved(guide.COURSE, folder))
    found = edition_plan.list_course_files(root)
    for name in sorted(found.known | found.new):  # what `git clone` would bring, and what is not committed yet
        (course / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(root / name, course / name)
    commands = guide.moved(guide.block("Install it once", "sh"), folder).splitlines()
    assert commands[0].startswith("git clone")
    wanted = (
        f"jupyterhub=={os.environ.get('COURSE_HUB', '6')}.* nbgitpuller"  # the session `hub` tries each major version
    )
    run_as_root([*commands[1:], f"{course}/.venv/bin/python -m pip install {wanted}"], folder)
    return course


def run_as_root(commands: Sequence[str], folder: Path) -> None:
    """Run lines of the guide in one shell, which ends at the first that fails."""
    done = subprocess.run(
        ["sh", "-euc", "\n".join(commands)], cwd=folder, env=clean_environment(folder), stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=_INSTALL_S, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


@dataclass(frozen=True)
class Hub:
    """A running JupyterHub.

    Attributes:
        address: with its base URL, without a slash at the end.
    """

    address: str
    token: str
    log: Path

    def stop_server(self, user: str) -> None:
        """Stop a user's server, as the service for idle servers does."""
        request = urllib.request.Request(  # noqa: S310 - an http address of this machine
            f"{self.address}/hub/api/users/{user}/server",
            method="DELETE",
            headers={"Authorization": f"token {self.token}"},
        )
        with urllib.request.urlopen(request, timeout=_DOWN_S):  # noqa: S310
            pass


@contextmanager
def hub(folder: Path, course: Path) -> Iterator[Hub]:
    """The guide's hub, with a password that is the same for all and ports of its own."""
    service = folder / "srv"
    service.mkdir(mode=0o700)
    ports = free_ports(3)
    token = secrets.token_hex(16)
    config = service / "jupyterhub_config.py"
    configured = guide.moved(guide.block("Configure the hub", "python"), folder)
    config.write_text(f"""{configured}
c.JupyterHub.ip = "127.0.0.1"
c.JupyterHub.port = {ports[0]}
c.JupyterHub.hub_port = {ports[1]}
c.ConfigurableHTTPProxy.api_url = "http://127.0.0.1:{ports[2]}"
c.JupyterHub.authenticator_class = "dummy"
c.DummyAuthenticator.password = {PASSWORD!r}
c.JupyterHub.services.append({{"name": "test", "api_token": {token!r}}})
c.JupyterHub.load_roles.append({{"name": "test", "services": ["test"], "scopes": ["delete:servers"]}})
""")
    log = service / "hub.log"
    with log.open("w") as written:
        process = subprocess.Popen(
            [course / ".venv/bin/jupyterhub", "-f", config], cwd=service, env=clean_environment(folder),
            stdin=subprocess.DEVNULL, stdout=written, stderr=written, start_new_session=True,
        )  # fmt: skip
        try:
            made = Hub(f"http://127.0.0.1:{ports[0]}/jupyter", token, log)
            wait_until_up(f"{made.address}/hub/login", process, log)
            yield made
        finally:
            process.send_signal(signal.SIGTERM)  # it stops the servers and the proxy
            with suppress(subprocess.TimeoutExpired):
                process.wait(_DOWN_S)
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def free_ports(count: int) -> list[int]:
    """Ports that nobody listens on."""
    held = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    found = [one.getsockname()[1] for one in held]
    for one in held:
        one.close()
    return found

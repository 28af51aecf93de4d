"""What `./course` hands over to when the environment it needs is not there: makes it, then starts `./course` again."""

from __future__ import annotations

import os
import shutil
import signal
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_setup.environments import Environments, held
from course_setup.installing import Installer
from course_setup.problems import SIZES, SetUpError, describe, require_usable, require_wheels, say

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Request:
    """What `./course` wants, and what it has found out. All are text, as they come from the command line."""

    root: str
    kind: str  # "jazzy" where a ROS 2 Jazzy is sourced, else "wheels"
    extra: str  # "" or "test"
    python: str
    made_with: str  # the Python that the user has asked for, now or before, or ""
    uv: str  # the one of this machine, or ""
    stamp: str  # fingerprint of what an environment is made from

    @property
    def system_ros(self) -> bool:
        """Whether the environment uses the packages of a ROS 2 outside of it."""
        return self.kind == "jazzy"

    @property
    def unlocked(self) -> bool:
        """Whether the user asks for the newest packages instead of those of the lock."""
        return bool(os.environ.get("COURSE_UNLOCKED"))

    @property
    def find_links(self) -> str:
        """The folder to install from, without the network, or ""."""
        folder = os.environ.get("COURSE_FIND_LINKS", "")
        return folder and os.path.abspath(folder)  # noqa: PTH100 - as the user names it, links and all


def main(arguments: Sequence[str]) -> int:
    """Make the environment, then replace this process by `./course` with the arguments that follow."""
    request, command = Request(*arguments[:7]), arguments[7:]
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _stop)
    try:
        set_up(request)
    except KeyboardInterrupt as stopped:
        say("stopped half-way. Run the same command again to go on.")
        return 128 + int(stopped.args[0])
    except SetUpError as problem:
        say(str(problem))
        return 2
    except OSError as problem:
        say(describe(problem, Path(request.root), request.kind))
        return 2
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them, and who is started next would, too
        signal.signal(number, signal.SIG_DFL)
    return os.execv("/bin/sh", ["sh", str(Path(request.root, "course")), *command])


def _stop(number: int, _frame: object) -> None:
    for other in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(other, signal.SIG_IGN)  # a second Ctrl-C would disturb the tidying up
    raise KeyboardInterrupt(number)


def set_up(request: Request) -> None:
    """Make the environment that is wanted; leave that to another process if one is at it."""
    root = Path(request.root)
    environments = Environments(root, request.kind)
    environments.require_face()
    require_usable(root, environments.folder)
    require_wheels(request.find_links)
    with held(environments.folder / "lock") as waited:
        if waited:  # `./course` looks what the other one has made
            return
        _make(environments, Installer(request, root), request)
    os.environ["COURSE_SET_UP_DONE"] = "1"


def _make(environments: Environments, installer: Installer, request: Request) -> None:
    old, fresh = environments.current(), environments.new()
    extra = "test" if old is not None and old.has("test") else request.extra  # once wanted, kept
    what = "JupyterLab and the course" if request.system_ros else "ROS 2, JupyterLab and the course"
    try:
        say("[1/2] making a Python environment in .venvs")
        installer.get_uv()
        installer.create(fresh)
        say(f"[2/2] installing {what} ({SIZES[request.kind]} on disk; once)")
        installer.install(fresh, with_tests=extra == "test")
        fresh.finish(request.stamp, extra, request.made_with, unlocked=request.unlocked)
        environments.put_in_force(fresh)
    finally:
        if environments.current() != fresh:
            shutil.rmtree(fresh.path, ignore_errors=True)
    environments.remove_unused(installer.uv, old)
    say("ready.")

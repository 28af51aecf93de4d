"""What `./course` hands over to when the environment it needs is not there: makes it, then starts `./course` again."""

from __future__ import annotations

import os
import shutil
import signal
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from course_setup import portable
from course_setup.environments import Environment, Environments, identity
from course_setup.installing import Installer
from course_setup.lock import held, held_if_free
from course_setup.problems import SetUpError, describe, require_usable, require_wheels, say, size

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class _StoppedError(BaseException):
    """A signal has come: Ctrl-C, or the terminal was closed."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


@dataclass(frozen=True)
class Request:
    """What `./course` wants, and what it has found out. All are text, as they come from the command line."""

    root: str
    kind: str  # "jazzy" where a ROS 2 Jazzy is sourced, else "wheels"
    extra: str  # "" or "test"
    python: str
    uv: str
    stamp: str  # fingerprint of what an environment is made from; its last line is the folder

    @property
    def made_with(self) -> str:
        """The Python the user asks for, or ""."""
        return os.environ.get("COURSE_PYTHON", "")

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
    """Make the environment, then replace this process by `./course` with the arguments that follow.

    Returns:
        128 + the signal's number where one has stopped it, 2 where the set-up could not be done.
    """
    request = Request(*arguments[:6])
    try:
        with _stoppable():
            set_up(request)
    except _StoppedError as stopped:
        say("stopped half-way. Run the same command again to go on.")
        return 128 + stopped.number
    except SetUpError as problem:
        say(str(problem))
        return 2
    except OSError as problem:
        say(describe(problem, Path(request.root), request.kind))
        return 2
    return _start_again(request, arguments[6:])


def show(root: str, kind: str) -> int:
    """Have `.venv` lead to the environment in force, if nothing stands against it."""
    environments = Environments(Path(root), kind)
    with suppress(OSError), held_if_free(environments.lock) as free:  # a folder of somebody else, for instance
        found = environments.current()
        if free and found is not None:
            environments.show(found)
    return 0


def set_up(request: Request) -> None:
    """Make the environment that is wanted, or bring it up to date; do nothing if another process has just done so.

    Raises:
        SetUpError: it cannot be done; the text is for the user.
        OSError: a file cannot be written.
    """
    root = Path(request.root)
    environments = Environments(root, request.kind)
    require_usable(root, environments.folder)
    require_wheels(request.find_links)
    with held(environments.lock):
        environments.take_over_old_layout()
        found = environments.current()
        if found is None or not _can_be_kept(found, environments, request):
            _make_new(environments, found, request)
        elif found.stamp == request.stamp and found.has(request.extra):
            found.finish(request.stamp, "", request.made_with)
            environments.show(found)
        elif found.has(request.extra) and _made_from(found.stamp) == _made_from(request.stamp):
            say("the folder has been moved; adapting its environment.")
            portable.adapt(found.path)
            found.finish(request.stamp, "", request.made_with)
            environments.show(found)
        else:
            _bring_up_to_date(environments, found, request)
        environments.remove_unused()


@contextmanager
def _stoppable() -> Iterator[None]:
    """Have signals raise an exception, except those that are ignored in this terminal."""

    def stop(number: int, frame: FrameType | None) -> None:
        del frame
        for other in _SIGNALS:
            signal.signal(other, signal.SIG_IGN)  # a second Ctrl-C would disturb the tidying up
        raise _StoppedError(number)

    heard = [number for number in _SIGNALS if signal.getsignal(number) != signal.SIG_IGN]
    for number in heard:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number in heard:
            signal.signal(number, signal.SIG_DFL)


def _start_again(request: Request, command: Sequence[str]) -> int:
    for number in (signal.SIGPIPE, signal.SIGXFSZ):  # Python ignores them, and who is started next would, too
        signal.signal(number, signal.SIG_DFL)
    os.environ["COURSE_SET_UP_DONE"] = "1"
    return os.execv("/bin/sh", ["sh", str(Path(request.root, "course")), *command])


def _can_be_kept(found: Environment, environments: Environments, request: Request) -> bool:
    """Whether an environment can be the base of what is wanted. Who has deleted `.venv` wants another one."""
    if not environments.face.is_symlink() or not found.works():
        return False
    if request.unlocked and not found.unlocked:  # in a copy an installer would leave what fits, however old it is
        return False
    return request.made_with in ("", found.made_with) or identity(request.made_with) == found.identity()


def _made_from(stamp: str) -> str:
    return stamp.rpartition("\n")[0]


def _make_new(environments: Environments, old: Environment | None, request: Request) -> None:
    installer = _installer(request)
    say("[1/2] making a Python environment in .venvs")
    fresh = environments.new()
    try:
        installer.create(fresh)
        say(f"[2/2] installing {_what(request)} ({size(request.kind)} on disk; once)")
        _install(installer, fresh, old, request)
        environments.put_in_force(fresh)
    finally:
        _drop_unless_in_force(fresh, environments)
    say("ready.")


def _bring_up_to_date(environments: Environments, old: Environment, request: Request) -> None:
    """Change a copy, so that whatever runs in the environment, or interrupts this, does it no harm."""
    fresh = environments.new()
    say(f"bringing the installation up to date ({'test tools' if request.extra else _what(request)})")
    try:
        portable.copy(old.path, fresh.path)
        _install(_installer(request), fresh, old, request)
        environments.put_in_force(fresh)
    finally:
        _drop_unless_in_force(fresh, environments)
    say("ready.")


def _install(installer: Installer, fresh: Environment, old: Environment | None, request: Request) -> None:
    extra = "test" if old is not None and old.has("test") else request.extra  # once wanted, kept
    installer.install(fresh, with_tests=extra == "test")
    fresh.finish(request.stamp, extra, request.made_with, unlocked=request.unlocked)


def _drop_unless_in_force(fresh: Environment, environments: Environments) -> None:
    if not environments.is_in_force(fresh):
        shutil.rmtree(fresh.path, ignore_errors=True)


def _installer(request: Request) -> Installer:
    return Installer(Path(request.root), request.python, request.uv, request.kind, request.unlocked, request.find_links)


def _what(request: Request) -> str:
    if request.kind == "jazzy":
        return "JupyterLab and the course"
    return "ROS 2, JupyterLab and the course"

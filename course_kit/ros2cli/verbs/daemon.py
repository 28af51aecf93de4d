"""`ros2 daemon`: start, stop, status."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.parser import add_verb, add_verbs

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros2cli.session import Session

_PATIENCE = 0.5


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    add_verb(verbs, "start", _start, "Start the daemon; commands do so when they need it, it ends with the last node")
    add_verb(verbs, "stop", _stop, "Stop the daemon")
    add_verb(verbs, "status", _status, "Say whether the daemon is running")


def _start(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit import environment
    from course_kit.ros2cli.daemon import DaemonSocket, ask_daemon

    environment.apply()
    if DaemonSocket.here().ask({"do": "graph", "patience": _PATIENCE}, _PATIENCE + 1.0):
        print("The daemon is already running")
    elif ask_daemon(_PATIENCE):
        print("The daemon has been started")
    else:
        raise CommandError("The daemon could not be started; listings work without it, and take longer.")


def _stop(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit.ros2cli.daemon import stop_daemon

    print("The daemon has been stopped" if stop_daemon() else "The daemon is not running")


def _status(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit import environment
    from course_kit.ros2cli.daemon import DaemonSocket

    environment.apply()
    running = DaemonSocket.here().ask({"do": "graph", "patience": _PATIENCE}, _PATIENCE + 1.0)
    print("The daemon is running" if running else "The daemon is not running")

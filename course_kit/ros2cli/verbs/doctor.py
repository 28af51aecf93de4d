"""`ros2 doctor`, also called `ros2 wtf`; and `ros2 daemon`: start, stop, status."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.ros2cli.parser import add_graph_options, add_verb, add_verbs
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.verbs._listing import graph_of

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

_PATIENCE = 0.5  # seconds for the daemon to answer


def add_to(place: ArgumentParser) -> None:
    """The command has no verbs."""
    place.add_argument("-iw", "--include-warnings", action="store_true", help="a warning is a failure, too")
    add_graph_options(place)
    place.set_defaults(run=_doctor)


def _doctor(options: Namespace, session: Session) -> None:
    from course_kit.ros2cli import checkup

    failed, found = [], checkup.run_checks(graph_of(options, session))
    for check in found:
        for line in (*(f"ERROR: {error}" for error in check.errors), *check.warnings):
            sys.stderr.write(f"UserWarning: {line}\n")
        if check.errors or (options.include_warnings and check.warnings):
            failed.append(check.category)
    sys.stderr.flush()
    if failed:
        print(f"\n{len(failed)}/{len(found)} check(s) failed\n\nFailed modules: {' '.join(failed)}")
    else:
        print(f"\nAll {len(found)} checks passed\n")
    print(f"Whether the course itself works on this machine: {environment.course_command()} doctor")


def add_daemon_to(place: ArgumentParser) -> None:
    """The verbs of `ros2 daemon`."""
    verbs = add_verbs(place)
    add_verb(verbs, "start", _start, "Start the daemon; commands start it, too, and it ends with the last node")
    add_verb(verbs, "stop", _stop, "Stop the daemon")
    add_verb(verbs, "status", _status, "Say whether the daemon is running")


def _start(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit.ros2cli.daemon import DaemonSocket, ask_daemon

    environment.apply_settings()
    if DaemonSocket.for_settings().ask({"do": "graph", "patience": _PATIENCE}, _PATIENCE + 1.0):
        print("The daemon is already running")
    elif ask_daemon(_PATIENCE):
        print("The daemon has been started")
    else:
        raise CommandError("The daemon could not be started; listings work without it, and take longer.")


def _stop(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit.ros2cli.daemon import DaemonSocket

    environment.apply_settings()
    stopped = DaemonSocket.for_settings().ask({"do": "stop"}, 5.0) is not None
    print("The daemon has been stopped" if stopped else "The daemon is not running")


def _status(options: Namespace, session: Session) -> None:
    del options, session
    from course_kit.ros2cli.daemon import DaemonSocket

    environment.apply_settings()
    running = DaemonSocket.for_settings().ask({"do": "graph", "patience": _PATIENCE}, _PATIENCE + 1.0)
    print("The daemon is running" if running else "The daemon is not running")

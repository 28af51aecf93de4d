"""What happens while a launch runs."""

from __future__ import annotations

import signal
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from course_kit.launch.action import Action

Matcher = Callable[[Any], bool]


@dataclass
class LaunchEvent:
    """Something that has happened."""


@dataclass
class Shutdown(LaunchEvent):
    """The launch ends, with all its processes."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass
class ExecutionComplete(LaunchEvent):
    """An action is done; one that starts a process, when that has ended."""

    action: Action


@dataclass
class RunningProcessEvent(LaunchEvent):
    """Something about a process."""

    action: Action
    process_name: str
    cmd: list[str] = field(default_factory=list)
    cwd: str | None = None
    env: dict[str, str] = field(default_factory=dict)
    pid: int = 0


@dataclass
class ProcessStarted(RunningProcessEvent):
    """A process has started."""


@dataclass
class ProcessExited(RunningProcessEvent):
    """A process has ended."""

    returncode: int = 0


@dataclass
class ProcessIO(RunningProcessEvent):
    """A process has written a line."""

    text: bytes = b""
    from_stdout: bool = False
    from_stderr: bool = False


@dataclass
class ShutdownProcess(LaunchEvent):
    """Those processes are to end."""

    process_matcher: Matcher


@dataclass
class SignalProcess(LaunchEvent):
    """Those processes are to get a signal."""

    signal_number: int | str
    process_matcher: Matcher

    @property
    def signal(self) -> signal.Signals:
        """The signal."""
        number = self.signal_number
        return signal.Signals[number] if isinstance(number, str) else signal.Signals(number)


def matches_action(target_action: Action) -> Matcher:
    """Says whether an action is this one."""
    return lambda action: action is target_action

"""One process of a launch: how its lines are marked, and how far its end has come."""

from __future__ import annotations

import shlex
from typing import IO, TYPE_CHECKING

from course_kit.process.child import NOWHERE, PIPE, Child
from course_kit.process.output import LineReader
from course_kit.process.signals import Ladder

if TYPE_CHECKING:
    from pathlib import Path

PATIENCE_S = (5.0, 5.0, 5.0)  # after SIGINT, SIGTERM and SIGKILL; the real launch's defaults


class LaunchedProcess:
    """A process of a launch file.

    Args:
        command: what to run.
        label: how its lines are marked, such as "parameter_node.py-1".
        environ: its environment.
        show_stdout: whether its stdout belongs on the screen; stderr always does.
        temporary: files that are its own.
        inherits: file descriptors it gets, and with them our own stdout and stderr, which it writes to directly.

    Attributes:
        process: the process.
        ladder: the signals it has got to end it.
        streams: its pipes, with the lines that come through each, and whether these are shown.
    """

    def __init__(  # noqa: PLR0913 - a process is described by that much
        self,
        command: list[str],
        label: str,
        environ: dict[str, str],
        *,
        show_stdout: bool,
        temporary: list[Path],
        inherits: tuple[int, ...] | None = None,
    ) -> None:
        self.label, self._temporary = label, temporary
        self.command = shlex.join(command)
        self.ladder = Ladder(*PATIENCE_S)
        self.process = Child(
            command,
            environ=environ,
            stdout=PIPE if inherits is None else None if show_stdout else NOWHERE,
            stderr=PIPE if inherits is None else None,
            descriptors=inherits or (),
            dies_with_us=True,  # launch has one thread
        )
        self.streams: dict[IO[bytes], tuple[LineReader, bool]] = {}
        for stream, shown in ((self.process.stdout, show_stdout), (self.process.stderr, True)):
            if stream is not None:
                self.streams[stream] = (LineReader(stream.fileno()), shown)

    def clean_up(self) -> None:
        """End what is left of its group, close its streams and remove its files."""
        self.process.kill()
        for path in self._temporary:
            path.unlink(missing_ok=True)

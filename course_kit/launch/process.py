"""One process of a launch: how its lines are marked, and how far its end has come."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING

from course_kit.process.child import NOWHERE, PIPE, Child
from course_kit.process.output import LineReader
from course_kit.process.signals import Ladder

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.launch.action import Action

PATIENCE_S = (5.0, 5.0, 5.0)  # after SIGINT, SIGTERM and SIGKILL; the real launch's defaults

# output= -> whether stdout and stderr belong on the screen; all of it goes into the log file
OUTPUTS = {
    "screen": (True, True),
    "both": (True, True),
    "full": (True, True),
    "log": (False, True),
    "own_log": (False, False),
}


@dataclass
class ProcessDescription:
    """A process of a launch."""

    action: Action
    command: list[str]
    label: str
    environ: Mapping[str, str]
    folder: str | None
    show: tuple[bool, bool]
    temporary: list[Path]
    respawn: bool
    respawn_delay_s: float


class LaunchedProcess:
    """A process of a launch file."""

    def __init__(
        self,
        description: ProcessDescription,
        label: str,
        *,
        command: list[str] | None = None,
        environ: dict[str, str] | None = None,
        inherits: tuple[int, ...] | None = None,
    ) -> None:
        self.description, self.label = description, label
        self.command = shlex.join(description.command)
        self.ladder = Ladder(*PATIENCE_S)
        show_stdout, show_stderr = description.show
        self.process = Child(
            command or description.command,
            environ=environ or description.environ,
            folder=description.folder,
            stdout=PIPE if inherits is None else None if show_stdout else NOWHERE,
            stderr=PIPE if inherits is None else None if show_stderr else NOWHERE,
            descriptors=inherits or (),
            dies_with_us=True,  # launch has one thread
        )
        self.streams: dict[IO[bytes], tuple[LineReader, bool]] = {}
        pipes = ((self.process.stdout, show_stdout), (self.process.stderr, show_stderr))
        for stream, shown in pipes:
            if stream is not None:
                self.streams[stream] = (LineReader(stream.fileno()), shown)

    def clean_up(self) -> None:
        """End what is left of its group, close its streams and remove its files, unless it starts once more."""
        self.process.kill()
        if not self.description.respawn:
            for path in self.description.temporary:
                path.unlink(missing_ok=True)

"""One process of a launch: how its lines are marked, and how far its end has come."""

from __future__ import annotations

import shlex
from typing import IO, TYPE_CHECKING

from course_kit.process.child import NOWHERE, PIPE, Child
from course_kit.process.output import LineReader
from course_kit.process.signals import Ladder

if TYPE_CHECKING:
    from course_kit.launch.process_description import ProcessDescription

PATIENCE_S = (5.0, 5.0, 5.0)  # after SIGINT, SIGTERM and SIGKILL; the real launch's defaults


class LaunchedProcess:
    """A process of a launch file."""

    def __init__(  # noqa: PLR0913 - a process is described by that much
        self,
        description: ProcessDescription,
        label: str,
        *,
        command: list[str] | None = None,
        environ: dict[str, str] | None = None,
        inherits: tuple[int, ...] | None = None,
        restarts: int = 0,
    ) -> None:
        self.description, self.label, self.restarts = description, label, restarts
        self.command = shlex.join(description.command)
        self.ladder = Ladder(*description.patience_s)
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
        self.streams: dict[IO[bytes], tuple[LineReader, bool, bool]] = {}
        pipes = ((self.process.stdout, show_stdout, True), (self.process.stderr, show_stderr, False))
        for stream, shown, is_stdout in pipes:
            if stream is not None:
                self.streams[stream] = (LineReader(stream.fileno()), shown, is_stdout)

    def may_restart(self) -> bool:
        """Whether it is to be started again when it has ended."""
        most = self.description.respawn_max
        return self.description.respawn and (most < 0 or self.restarts < most)

    def clean_up(self) -> None:
        """End what is left of its group, close its streams and remove its files, unless it starts once more."""
        self.process.kill()
        if not self.may_restart():
            for path in self.description.temporary:
                path.unlink(missing_ok=True)

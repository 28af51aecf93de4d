"""What is to be started: the command of a process, and what belongs to it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.launch.action import Action
    from course_kit.launch.context import LaunchContext

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
    """A process of a launch.

    Attributes:
        action: the Node or ExecuteProcess it comes from.
        context: of that action.
        command: the program and its arguments.
        label: what its lines begin with, before the number.
        environ: its environment.
        folder: its working directory; ours if None.
        show: whether its stdout, and its stderr, are shown or only logged.
        temporary: files that are removed when it has ended.
        patience_s: seconds it has to end in after SIGINT, after SIGTERM, and after SIGKILL.
        respawn: whether it is started again when it has ended.
        respawn_delay_s: seconds until then.
        respawn_max: how often; any number of times if negative.
    """

    action: Action
    context: LaunchContext
    command: list[str]
    label: str
    environ: Mapping[str, str]
    folder: str | None = None
    show: tuple[bool, bool] = OUTPUTS["log"]
    temporary: list[Path] = field(default_factory=list)
    patience_s: tuple[float, float, float] | None = None
    respawn: bool = False
    respawn_delay_s: float = 0.0
    respawn_max: int = -1

"""What is to be started: the command of a process, and what belongs to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from course_kit.launch.action import Action

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
    patience_s: tuple[float, float, float]
    respawn: bool
    respawn_delay_s: float
    respawn_max: int

"""What is known while a launch file runs."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.launch.errors import LaunchError

if TYPE_CHECKING:
    from course_kit.launch.service import LaunchService
    from course_kit.launch.substitutions import Substitution


@dataclass
class LaunchContext:
    """The values of launch arguments, and where the file stands."""

    launch_configurations: dict[str, str] = field(default_factory=dict)
    file: Path = Path("launch.py")
    environment: dict[str, str] = field(default_factory=lambda: dict(os.environ))
    namespace: str = ""
    parameters: dict[str, object] = field(default_factory=dict)
    depth: int = 0
    declared: set[str] = field(default_factory=set)
    running: LaunchService | None = None

    @property
    def service(self) -> LaunchService:
        """What runs the processes."""
        if self.running is None:
            raise LaunchError("This can only be done while a launch file runs.")
        return self.running

    @property
    def is_shutdown(self) -> bool:
        """Whether the launch is about to end."""
        return self.running is not None and self.running.stopping

    def inside(self, file: Path) -> LaunchContext:
        """The context for an included file; its values are the same ones."""
        return replace(self, file=file, depth=self.depth + 1)

    def scoped(self, *, forwarding: bool = True) -> LaunchContext:
        """The context within a group: what is set there is forgotten behind it."""
        return replace(
            self,
            launch_configurations=dict(self.launch_configurations) if forwarding else {},
            environment=dict(self.environment),
            parameters=dict(self.parameters),
        )

    def perform_substitution(self, substitution: Substitution) -> str:
        """The text that a substitution becomes."""
        return substitution.perform(self)

    def emit_event_sync(self, event: Any) -> None:
        """Tell those who wait for an event."""
        self.service.emit(event)

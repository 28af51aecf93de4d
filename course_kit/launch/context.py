"""What is known while a launch file runs."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path


@dataclass
class LaunchContext:
    """The values of launch arguments, and where the file stands.

    Attributes:
        launch_configurations: argument names to values, shared with included files as in the real launch.
        file: the launch file being run.
    """

    launch_configurations: dict[str, str] = field(default_factory=dict)
    file: Path = Path("launch.py")

    def inside(self, file: Path) -> LaunchContext:
        """The context for an included file; its values are the same ones."""
        return replace(self, file=file)

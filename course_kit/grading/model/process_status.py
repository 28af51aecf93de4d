"""What is known of a submission's process while a check runs."""

from __future__ import annotations

from dataclasses import dataclass, field

from course_kit.grading.model.plain_data import Record  # noqa: TC001 - msgspec looks it up


@dataclass(frozen=True)
class ProcessStatus:
    """What the supervisor knows of the submission; hints for the diagnosis, see `sandbox.output_collector`."""

    running: bool
    exit_code: int | None = None
    signal: int | None = None
    limit: str | None = None
    cpu_s: float = 0.0
    waited_s: float = 0.0
    hidden_s: float = 0.0
    tasks: int = 0
    memory: int = 0
    stdout: str = ""
    stderr: str = ""
    notes: Record = field(default_factory=dict)

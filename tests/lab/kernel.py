"""Runs cells in a real kernel and collects what a notebook would show."""

from __future__ import annotations

import os
import queue
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jupyter_client.manager import KernelManager

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType

DEADLINE = 40.0  # seconds; only against hanging


@dataclass
class Shown:
    """What one cell has shown."""

    ok: bool = True
    stdout: str = ""
    stderr: str = ""
    error: str = ""
    result: dict[str, Any] = field(default_factory=dict)

    def take(self, kind: str, content: dict[str, Any]) -> None:
        if kind == "stream":
            setattr(self, content["name"], getattr(self, content["name"]) + content["text"])
        elif kind == "error":
            self.ok = False
            self.error += "\n".join(content["traceback"])
        elif kind in {"execute_result", "display_data"}:
            self.result = content["data"]


class Kernel:
    """One kernel process."""

    def __init__(self, cwd: Path) -> None:
        self.manager = KernelManager()
        self.cwd = cwd

    def __enter__(self) -> Kernel:  # noqa: PYI034 - typing.Self is newer than Python 3.10
        environment = dict(os.environ)
        environment.pop("PYTEST_CURRENT_TEST", None)
        self.manager.start_kernel(cwd=str(self.cwd), env=environment)
        self.client = self.manager.client()
        self.client.start_channels()
        self.client.wait_for_ready(timeout=DEADLINE)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.client.stop_channels()
        if self.manager.is_alive():
            self.manager.shutdown_kernel(now=kind is not None)
        self.manager.cleanup_resources()

    @property
    def pid(self) -> int:
        return int(self.manager.provisioner.pid)

    def send(self, code: str, **metadata: object) -> str:
        """Begin to run a cell, with what JupyterLab tells of it; returns its message's id."""
        content = {"code": code, "silent": False, "store_history": True, "user_expressions": {}, "allow_stdin": False}
        message = self.client.session.msg("execute_request", content, metadata=metadata)
        self.client.shell_channel.send(message)
        return str(message["header"]["msg_id"])

    def finish(self, message: str, *, until: str | None = None) -> Shown:
        """Collect a cell's outputs until it has ended, or until `until` was printed."""
        shown = Shown()
        deadline = time.monotonic() + DEADLINE
        while time.monotonic() < deadline:
            try:
                received = self.client.get_iopub_msg(timeout=deadline - time.monotonic())
            except queue.Empty:
                break
            if received["parent_header"].get("msg_id") != message:
                continue
            if received["msg_type"] == "status" and received["content"]["execution_state"] == "idle":
                return shown
            shown.take(received["msg_type"], received["content"])
            if until is not None and until in shown.stdout + shown.stderr:
                return shown
        raise AssertionError(f"The cell did not end within {DEADLINE} s. So far: {shown}")

    def run(self, code: str, **metadata: object) -> Shown:
        """Run a cell to its end."""
        return self.finish(self.send(code, **metadata))

    def complete(self, code: str) -> set[str]:
        """What Tab offers after some code."""
        message = self.client.complete(code)
        while True:
            reply = self.client.get_shell_msg(timeout=DEADLINE)
            if reply["parent_header"].get("msg_id") == message:
                return {str(match).rpartition(".")[2] for match in reply["content"]["matches"]}

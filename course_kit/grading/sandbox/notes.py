"""What a program's process tells the grader beside what stands on the ROS graph: hints for the diagnosis, never points.

And how an exception of the program is shown: as Python does it, without the grader's own frames.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import threading
    from types import TracebackType

_OURS = Path(__file__).parent
# Where rclpy holds what a callback has returned: by function, the name of our note and that of its variable.
_RETURNED = {"send_response": ("returned", "response"), "_execute_goal": ("result", "execute_result")}


def print_exception(problem: BaseException) -> None:
    """Print the traceback as Python does, beginning with the learner's own file."""
    problem.__traceback__ = _own_part(problem.__traceback__)
    traceback.print_exception(type(problem), problem, problem.__traceback__)


def _own_part(trace: TracebackType | None) -> TracebackType | None:
    part = trace
    while part is not None and Path(part.tb_frame.f_code.co_filename).parent == _OURS:
        part = part.tb_next
    return part


def note_thread_failure(hook: threading.ExceptHookArgs, evidence: int) -> None:
    """Show and note an exception that has ended a thread."""
    if hook.exc_value is not None and hook.exc_type is not SystemExit:
        traceback.print_exception(hook.exc_type, hook.exc_value, hook.exc_traceback)
        note_refused_return(hook.exc_value, evidence)


def note_refused_return(problem: BaseException, evidence: int) -> None:
    """Note what a callback returned when rclpy refused to send it; its own exception does not say."""
    for frame, _ in traceback.walk_tb(problem.__traceback__):
        note, variable = _RETURNED.get(frame.f_code.co_name, ("", ""))
        if variable in frame.f_locals:
            value = frame.f_locals[variable]
            send_note(evidence, **{note: "None" if value is None else type(value).__name__})


def watch_lost_nodes(evidence: int, program: str) -> None:
    """Note the line of a callback that spins its node by another executor than the one that runs it: for good."""
    from rclpy.executors import Executor

    add_node = Executor.add_node

    def add_node_watched(executor: Executor, node: Any) -> bool:
        before = node.executor
        if before is not None and before is not executor and node in before.get_nodes():
            frames = list(traceback.walk_stack(sys._getframe(1)))  # noqa: SLF001 - with None it skips some
            own = [line for frame, line in frames if frame.f_code.co_filename == program]
            if own and any(frame.f_code.co_name == "await_or_execute" for frame, _ in frames):
                send_note(evidence, lost_in=f"{program}:{own[0]}")
        return bool(add_node(executor, node))

    setattr(Executor, "add_node", add_node_watched)  # noqa: B010 - mypy forbids to assign to a method


def comes_from_callback(problem: BaseException) -> bool:
    """Whether it was raised in a callback that rclpy ran."""
    return any(frame.f_code.co_name == "await_or_execute" for frame, _ in traceback.walk_tb(problem.__traceback__))


def send_note(evidence: int, **what: object) -> None:
    """Send a note to the grader."""
    os.write(evidence, b"\n" + json.dumps({"note": what}).encode() + b"\n")

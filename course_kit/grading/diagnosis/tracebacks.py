"""Reads Python's own accounts of a program: the traceback it died with, and what its threads are doing.

Both come from inside the submission and may be forged; they explain a failure and never earn a point.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import PurePath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

_SCRATCH = "/course-kit-"  # is in the path of what lies in a scratch directory
_HANDING_OVER = ("publish", "publish_feedback", "call_async", "send_goal_async", "log")
_OF_CALLBACKS = ("rclpy/executors.py", "rclpy/task.py")
_RUN_CALLBACKS = {"await_or_execute", "_execute", "handler", "__call__"}
_HEADER = "Traceback (most recent call last):"
_FILE_LINE = re.compile(r'^\s+File "(?P<file>[^"]*)", line (?P<line>\d{1,9})(?:,)? in (?P<function>.+)$')
_EXCEPTION = re.compile(r"^(?P<type>[A-Za-z_][\w.]*)(?:: (?P<text>.*))?$")
_THREAD = re.compile(r"^(?:Current thread|Thread) 0x[0-9a-f]+.*\(most recent call first\)")


@dataclass(frozen=True)
class Frame:
    """One level of a stack."""

    file: str
    line: int
    function: str


@dataclass(frozen=True)
class TracebackException:
    """An exception as a traceback tells it."""

    type: str  # the exception's name without its module
    text: str  # its message, first line only
    own: Frame | None  # the learner's own line nearest to where it was raised, None if it lies elsewhere
    frames: tuple[Frame, ...]  # the whole stack, outermost first

    def describe(self) -> str:
        """`ValueError: text`, as Python prints it."""
        return f"{self.type}: {self.text}" if self.text else self.type


def last_exception(stderr: str, programs: Collection[str]) -> TracebackException | None:
    """The last complete traceback in what programs, by the names of their files, wrote to stderr, or None."""
    lines = stderr.splitlines()
    above = ["", *lines]  # what Python could only mention, such as an exception in a finalizer, has a line above it
    ignored = [line.startswith("Exception ignored") for line in above]
    begins = [number for number, line in enumerate(lines) if _HEADER in line and not ignored[number]]
    if not begins:
        return None
    frames = []
    for line in lines[begins[-1] + 1 :]:
        if match := _FILE_LINE.match(line):
            frames.append(Frame(match["file"], int(match["line"]), match["function"]))
        elif line and not line[0].isspace() and (match := _EXCEPTION.match(line)):
            own = [frame for frame in frames if _is_own(frame, programs)]
            kind = match["type"].rpartition(".")[2]
            return TracebackException(kind, (match["text"] or "").strip(), own[-1] if own else None, tuple(frames))
    return None


def _is_own(frame: Frame, programs: Collection[str]) -> bool:
    """Whether a line is the learner's: a file that was imported has a whole path."""
    return frame.file in programs or (_SCRATCH in frame.file and PurePath(frame.file).name in programs)


@dataclass(frozen=True)
class Activity:
    """What a program that does not answer is doing."""

    known: bool = False  # its threads could be looked at
    spinning: bool = False  # some thread is in an rclpy executor
    # the learner's own line that a callback has reached, None when no callback is running
    callback: Frame | None = None
    waits_for_ros: bool = False  # that callback waits in rclpy itself: a synchronous call, or a spin
    own: Frame | None = None  # the learner's own line of any thread, callbacks first


def read_activity(dump: str, programs: Collection[str]) -> Activity:
    """Interpret a dump of all threads by faulthandler."""
    spinning, callback, waits, anywhere = False, None, False, None
    stacks: list[list[Frame]] = []
    for line in dump.splitlines():
        if _THREAD.match(line):
            stacks.append([])
        elif stacks and (match := _FILE_LINE.match(line)):
            stacks[-1].append(Frame(match["file"], int(match["line"]), match["function"]))
    for stack in stacks:
        own = [place for place, frame in enumerate(stack) if _is_own(frame, programs)]
        spinning = spinning or any(frame.file.endswith("rclpy/executors.py") for frame in stack)
        if not own:
            continue
        anywhere = anywhere or stack[own[0]]
        callers = {frame.function for frame in stack[own[0] + 1 :] if frame.file.endswith(_OF_CALLBACKS)}
        if not waits and callers & _RUN_CALLBACKS:  # else on its way to spin
            callback = stack[own[0]]
            called = [frame for frame in stack[: own[0]] if "rclpy/" in frame.file]  # by the learner's line
            waits = bool(called) and not any(frame.function in _HANDING_OVER for frame in called)
    return Activity(bool(stacks), spinning, callback, waits, callback or anywhere)

"""A callback's error in three lines: whose it is, what it is, and where in the learner's own code."""

from __future__ import annotations

import inspect
import linecache
import sysconfig
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit import environment
from course_kit.lab.errors import DeadlockError, InputError
from course_kit.lab.recording.hooks import WrongResponseError, failure_text
from course_kit.lab.runtime.advice import advice_on

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import CodeType, FrameType

    from rclpy.node import Node

    Locate = Callable[[str], str | None]

_NOT_THE_LEARNERS = tuple(
    dict.fromkeys(
        [
            str(environment.PACKAGE),
            *(sysconfig.get_paths()[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")),
            "<frozen",
        ]
    )
)


class Crash(NamedTuple):
    """What is known about a callback that failed; text only, so that no frame is kept alive."""

    node: str
    callback: str
    error: str
    place: str
    source: str
    advice: str = ""

    def text(self, ending: str) -> str:
        """The message for the notebook; `ending` says what follows from it."""
        who = f"{self.node}: " if self.node else ""
        lines = [f"{who}{self.callback or 'a callback'} {self.error}"]
        if self.place:
            lines.append(f"  {self.place}: {self.source}")
        if self.advice:
            lines.append(f"  {self.advice}")
        return "\n".join([*lines, f"  {ending}", ""])


def own_line(filename: str, number: int, locate: Locate) -> tuple[str, str]:
    """How to call a line of the learner's, and its text."""
    place = locate(filename) or Path(filename).name
    return f"{place}, line {number}", linecache.getline(filename, number).strip()


def is_own(filename: str) -> bool:
    """Whether code of this file is the learner's, not ours, rclpy's or Python's."""
    return not filename.startswith(_NOT_THE_LEARNERS)


def examine(error: BaseException, entity: Any, node: Node | None, locate: Locate) -> Crash:
    """Find out about an error while its traceback is there."""
    frames = [(frame, number) for frame, number in traceback.walk_tb(error.__traceback__)]
    own = [(frame, number) for frame, number in frames if is_own(frame.f_code.co_filename)]
    callback = getattr(entity, "callback", None)
    function = getattr(callback, "__name__", "") or (own[0][0].f_code.co_name if own else "")
    owner = node if node is not None else _node_in(frame for frame, _ in own)
    name = owner.get_name() if owner is not None else ""
    code = getattr(inspect.unwrap(callback), "__code__", None) if callback else None
    if own and not isinstance(error, WrongResponseError):
        place, source = own_line(own[-1][0].f_code.co_filename, own[-1][1], locate)
    else:  # it has not run, or what it returned is wrong
        place, source = _definition(code, locate)
    if isinstance(error, WrongResponseError):
        return Crash(name, function, error.what, place, source)
    if isinstance(error, (DeadlockError, InputError)):
        return Crash(name, function, f"was stopped: {error}", place, source)
    return Crash(name, function, f"raised {failure_text(error)}", place, source, advice_on(error, owner, entity))


def where_is(frame: FrameType | None, locate: Locate) -> tuple[str, str] | None:
    """The innermost line of the learner's in a running thread, as `own_line` gives it."""
    while frame is not None:
        if is_own(frame.f_code.co_filename):
            return own_line(frame.f_code.co_filename, frame.f_lineno, locate)
        frame = frame.f_back
    return None


def _node_in(frames: Iterator[FrameType]) -> Any:
    for frame in frames:
        candidate = frame.f_locals.get("self")
        if hasattr(candidate, "get_fully_qualified_name"):
            return candidate
    return None


def _definition(code: CodeType | None, locate: Locate) -> tuple[str, str]:
    if code is None or not is_own(code.co_filename):
        return "", ""
    return own_line(code.co_filename, code.co_firstlineno, locate)

"""The Stop button: pressed again it stops again; and it says one line, not where in asyncio a cell was waiting."""

from __future__ import annotations

import asyncio
import signal
import sys
import threading
import traceback
from typing import TYPE_CHECKING, Any

from course_kit.lab.errors import LabError
from course_kit.lab.runtime.failures import explain_error

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

    from course_kit.lab.overrides.patches import Patches

    ExceptionTuple = tuple[type[BaseException], BaseException, TracebackType | None]

_INTERRUPTS = (KeyboardInterrupt, asyncio.CancelledError)


class _BriefError(Exception):
    """Shown in place of an error whose traceback says less than a sentence."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


class _Interrupted(KeyboardInterrupt):
    """Shown in place of the interrupt itself."""

    def _render_traceback_(self) -> list[str]:
        return [str(self)]


def tell_briefly(
    patches: Patches, shell: Any, locate: Callable[[str], str | None], nodes_run: Callable[[], bool]
) -> None:
    """Have an interrupted cell say where it was and that nodes go on; and what ROS refuses be one sentence."""
    show = shell.showtraceback

    def tell(exc_tuple: ExceptionTuple | None = None, *place: Any, **more: Any) -> None:
        kind, error, trace = exc_tuple or sys.exc_info()
        if kind is None or error is None or not issubclass(kind, _INTERRUPTS):
            if error is not None and not isinstance(error, LabError) and (text := explain_error(error, locate)):
                show((kind, _BriefError(text), trace))
            else:
                show(exc_tuple, *place, **more)
            return
        places = [
            f"{name}, line {number}"
            for frame, number in traceback.walk_tb(trace)
            if (name := locate(frame.f_code.co_filename))
        ]
        where = places[-1] if places else f"In[{shell.execution_count}]"
        rest = "; your nodes go on." if nodes_run() else "."
        show((kind, _Interrupted(f"Interrupted in {where}{rest}"), trace))

    patches.set(shell, "showtraceback", tell)


class Stop:
    """The Stop button, while a cell runs.

    Of a cell with `await`, ipykernel cancels the task at the first press and never again. Code may keep that to
    itself: `asyncio.wait_for` does until Python 3.11, when it comes together with what was waited for. So each further
    press cancels it once more.
    """

    def __init__(self) -> None:
        self._presses = 0

    def was_pressed(self) -> bool:
        """Whether it was, in the cell that has ended now."""
        return self._presses > 0

    def listen(self) -> None:
        """A cell begins; ipykernel puts back what was there before it."""
        self._presses = 0
        if threading.current_thread() is not threading.main_thread():
            return
        first = signal.getsignal(signal.SIGINT)
        if not callable(first):
            return
        loop, task = _running_task()
        cancels = task is not None and getattr(first, "__module__", "").startswith("ipykernel")

        def press(number: int, frame: FrameType | None) -> None:
            self._presses += 1
            if cancels and self._presses > 1:
                loop.call_soon_threadsafe(task.cancel)
            first(number, frame)

        press.of_the_lab = True  # type: ignore[attr-defined] # a terminal keeps it from one command to the next
        if not hasattr(first, "of_the_lab"):
            signal.signal(signal.SIGINT, press)


def _running_task() -> tuple[Any, Any]:
    try:
        return asyncio.get_running_loop(), asyncio.current_task()
    except RuntimeError:  # a terminal
        return None, None

"""The Stop button: pressed again it stops again; and it says one line, not where in asyncio a cell was waiting."""

from __future__ import annotations

import asyncio
import signal
import sys
import threading
import traceback
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

    from course_kit.lab.overrides.patches import Patches

    ExceptionTuple = tuple[type[BaseException], BaseException, TracebackType | None]

_INTERRUPTS = (KeyboardInterrupt, asyncio.CancelledError)


class _Interrupted(KeyboardInterrupt):
    """Shown in place of the interrupt itself."""

    def _render_traceback_(self) -> list[str]:
        """IPython's hook, as in `lab.errors`."""
        return [str(self)]


def tell_briefly(
    patches: Patches, shell: Any, locate: Callable[[str], str | None], nodes_run: Callable[[], bool]
) -> None:
    """Have an interrupted cell say that it was, where, and that nodes go on."""
    show = shell.showtraceback

    def tell(exc_tuple: ExceptionTuple | None = None, *place: Any, **more: Any) -> None:
        kind, _, trace = exc_tuple or sys.exc_info()
        if kind is None or not issubclass(kind, _INTERRUPTS):
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


def let_stop_repeat() -> None:
    """Have each further press of Stop cancel the cell that is running once more."""
    if threading.current_thread() is not threading.main_thread():
        return
    first = signal.getsignal(signal.SIGINT)
    try:
        loop, task = asyncio.get_running_loop(), asyncio.current_task()
    except RuntimeError:  # a terminal
        return
    if task is None or not callable(first) or not getattr(first, "__module__", "").startswith("ipykernel"):
        return  # a cell without `await`, which Python itself interrupts
    again = False

    def press(number: int, frame: FrameType | None) -> None:
        nonlocal again
        first(number, frame)
        if again:
            loop.call_soon_threadsafe(task.cancel)
        again = True

    signal.signal(signal.SIGINT, press)  # ipykernel puts back what was there before the cell

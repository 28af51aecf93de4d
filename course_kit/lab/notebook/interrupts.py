"""The Stop button: pressed again it stops again; and it says one line, not where in asyncio a cell was waiting."""

from __future__ import annotations

import asyncio
import signal
import threading
import traceback
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import FrameType, TracebackType

_INTERRUPTS = (KeyboardInterrupt, asyncio.CancelledError)


class _Interrupted(KeyboardInterrupt):
    """Shown in place of the interrupt itself."""

    def _render_traceback_(self) -> list[str]:
        """IPython's hook, as in `lab.errors`."""
        return [str(self)]


def tell_briefly(shell: Any, locate: Callable[[str], str | None], nodes_run: Callable[[], bool]) -> None:
    """Have an interrupted cell say that it was, where, and that nodes go on.

    Args:
        shell: IPython's.
        locate: what a cell is called, by its file name.
        nodes_run: whether there are nodes.
    """
    if shell.custom_exceptions:  # somebody else's
        return

    def tell(
        shell: Any, kind: type[BaseException], error: BaseException, trace: TracebackType, tb_offset: int | None = None
    ) -> None:
        del error, tb_offset
        places = [
            f" in {name}, line {number}"
            for frame, number in traceback.walk_tb(trace)
            if (name := locate(frame.f_code.co_filename))
        ]
        where = places[-1] if places else ""
        rest = "; your nodes go on." if nodes_run() else "."
        shell.showtraceback((kind, _Interrupted(f"Interrupted{where}{rest}"), trace))

    shell.set_custom_exc(_INTERRUPTS, tell)


def tell_at_length(shell: Any) -> None:
    """Give it back to IPython."""
    if shell.custom_exceptions == _INTERRUPTS:
        shell.set_custom_exc((), None)


def let_stop_repeat() -> None:
    """Have each further press of Stop cancel the cell that is running once more.

    Of a cell with `await`, ipykernel cancels the task at the first press and never again. Code may keep that to
    itself: `asyncio.wait_for` does until Python 3.11, when it comes together with what was waited for.
    """
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

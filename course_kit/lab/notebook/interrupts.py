"""What the Stop button says: one line in place of where inside asyncio or rclpy the cell was waiting."""

from __future__ import annotations

import asyncio
import traceback
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType

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

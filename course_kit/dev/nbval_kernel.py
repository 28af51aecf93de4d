"""A kernel for nbval that ends as Jupyter's do, and whose death is noticed at once."""

from __future__ import annotations

import os
import time
from queue import Empty

from nbval.kernel import RunningKernel

_POLL_S = 1.0


class CourseKernel(RunningKernel):  # type: ignore[misc]  # it has no types
    """A kernel that is asked to end, and whose death ends the wait for it."""

    def __init__(self, *arguments: object, **options: object) -> None:
        # Inherited by the kernel, it would silence what its native libraries print.
        current = os.environ.pop("PYTEST_CURRENT_TEST", None)
        try:
            super().__init__(*arguments, **options)
        finally:
            if current is not None:
                os.environ["PYTEST_CURRENT_TEST"] = current

    def await_reply(self, msg_id: str, timeout: float | None = None) -> None:
        """Wait for the reply in short steps, looking each time whether the kernel still lives.

        Raises:
            queue.Empty: no reply came in time, or the kernel has died.
        """
        deadline = None if timeout is None else time.monotonic() + timeout
        while not self._replied(msg_id):
            if not self.is_alive():
                raise RuntimeError("The kernel has died while it ran this cell.")
            if deadline is not None and time.monotonic() > deadline:
                raise Empty

    def _replied(self, msg_id: str) -> bool:
        try:
            super().await_reply(msg_id, timeout=_POLL_S)
        except Empty:
            return False
        return True

    def stop(self) -> None:
        """Ask the kernel to end; only one that does not is killed."""
        self.kc.stop_channels()
        try:
            self.km.shutdown_kernel(now=False)
        finally:
            del self.km

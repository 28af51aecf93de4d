"""Waiting for what happens in another thread or process."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

PATIENCE_S = 300.0  # against hanging only


def wait_until(
    condition: Callable[[], object], what: str | Callable[[], object] = "it", patience_s: float = PATIENCE_S
) -> None:
    """Return as soon as the condition holds.

    Args:
        condition: asked again and again.
        what: is waited for; or a function that tells what there is instead.
        patience_s: after so many seconds the test has failed.
    """
    deadline, pause = time.monotonic() + patience_s, threading.Event()
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError(
                f"{what} has not come within {patience_s:g} s" if isinstance(what, str) else f"There is only: {what()}"
            )
        pause.wait(0.01)

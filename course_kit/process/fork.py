"""A child process that runs a function of ours and never goes on in its parent's code."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def fork(run: Callable[[], object], *, failed: int = 1) -> int:
    """Fork, and have the child run a function and end."""
    if child := os.fork():
        return child
    status = failed
    try:
        run()
        status = 0
    except BaseException:  # noqa: BLE001 - whatever it is ends the child; the parent learns of it by the status
        sys.excepthook(*sys.exc_info())
    finally:
        os._exit(status)

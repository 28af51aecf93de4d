"""Ctrl-C in a process that was started with it switched off."""

from __future__ import annotations

import signal
import threading


def heed_interrupts() -> None:
    """Have SIGINT raise KeyboardInterrupt in this process, and end its children, as in one started at a terminal.

    What a script starts in the background has to ignore SIGINT, and so has everything that is started from there.
    Python leaves it at that and raises no KeyboardInterrupt, so that nothing would end what waits for one.
    """
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)

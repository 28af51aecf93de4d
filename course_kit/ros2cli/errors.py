"""What goes wrong, in one line."""

from __future__ import annotations


class CommandError(Exception):
    """A verb cannot do what was asked; the message is the one line that goes to stderr.

    Attributes:
        exit_code: what the process ends with; 1 as the real command does unless recorded otherwise.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(" ".join(message.split()))
        self.exit_code = exit_code

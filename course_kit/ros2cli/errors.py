"""What goes wrong, in one line."""

from __future__ import annotations


class CommandError(Exception):
    """A verb cannot do what was asked; the message is the one line that goes to stderr."""

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(" ".join(message.split()))
        self.exit_code = exit_code

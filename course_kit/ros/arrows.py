"""One arrow of a sequence diagram: who said what to whom. The recorder of a lab and the report of a grade draw them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal[
    "request",
    "response",
    "message",
    "failure",
    "note",
    "goal",
    "goal response",
    "feedback",
    "cancel request",
    "cancel response",
    "result",
]


@dataclass(frozen=True)
class Arrow:
    """One thing that was sent; or, as a "failure", that never came; or, as a "note", a remark between the arrows."""

    sender: str
    receiver: str
    kind: Kind
    text: str
    channel: str = ""

    @property
    def sign(self) -> str:
        """An arrow for plain text, `->`; with a cross for what never came."""
        return "--x" if self.kind == "failure" else "->"

    def __str__(self) -> str:
        """The arrow as a line of a list, without its channel."""
        return self.text if self.kind == "note" else f"{self.sender} {self.sign} {self.receiver}: {self.text}"

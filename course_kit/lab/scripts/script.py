"""One program as a child process."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.lab.errors import ScriptError

if TYPE_CHECKING:
    import threading

    from course_kit.process.child import Child


class Script:
    """A running program."""

    def __init__(self, name: str, process: Child) -> None:
        self.name = name
        self.process = process
        self.nodes: list[str] = []
        self.spins = ""
        self.stopping = False
        self.follower: threading.Thread | None = None

    @property
    def running(self) -> bool:
        """Whether it has not ended."""
        return self.process.exit_code() is None

    def __repr__(self) -> str:
        code = self.process.exit_code()
        if code is None:
            return f"{self.name} is running."
        return f"{self.name} has ended." if code == 0 or self.stopping else f"{self.name} ended with exit code {code}."


def checked_name(name: str) -> str:
    """The name without ".py"; raises ScriptError for one that cannot be a file's."""
    bare = name.removesuffix(".py")
    if not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_.-]*", bare):
        raise ScriptError(f"{name!r} cannot name a script: use letters, digits and underscores, such as server.")
    return bare

"""Which export files there are, so that those of a student or grade that is gone go, too, and nothing else does."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from course_kit.environment import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_LIST = "exports/.files.json"


class FilesWritten:
    """The list of export files in an output folder."""

    def __init__(self, out: Path) -> None:
        self._out = out
        self._before = _names(out)

    def begin(self, names: Iterable[str]) -> None:
        """Note what is going to be written, beside what is there: a run may end before `end`."""
        self._note(self._before | set(names))

    def end(self, names: Iterable[str]) -> None:
        """Take away what was written once and is not among `names`."""
        for name in self._before - set(names):
            (self._out / name).unlink(missing_ok=True)
            with suppress(OSError):  # one holds more
                for folder in list(PurePosixPath(name).parents)[:-1]:  # but the output folder itself
                    (self._out / folder).rmdir()
        self._note(set(names))

    def _note(self, names: set[str]) -> None:
        write_atomically(self._out / _LIST, json.dumps(sorted(names), indent=0) + "\n", durable=False)


def _names(out: Path) -> set[str]:
    """What an earlier run has noted; nothing outside of `exports`, whatever stands in the list."""
    try:
        found = json.loads((out / _LIST).read_text(encoding="utf-8"))
        paths = [PurePosixPath(name) for name in found]
    except (OSError, ValueError, TypeError):
        return set()
    return {str(path) for path in paths if path.parts[:1] == ("exports",) and ".." not in path.parts}

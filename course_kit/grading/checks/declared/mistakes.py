"""An author's mistakes in an exercise's files, collected so that all are told at once, each with its line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from pathlib import Path


class MistakeList:
    """What is wrong with the files of an exercise."""

    def __init__(self, path: Path) -> None:
        """Begin without any.

        Args:
            path: the file that mistakes are in unless they name another.
        """
        self._path = path
        self._found: list[tuple[str, int, str]] = []

    def add(self, line: int, text: str, path: Path | None = None) -> None:
        """Keep one.

        Args:
            line: where; 0 when it stands nowhere.
            text: what is wrong and what to do, in whole sentences.
            path: the file, when it is another.
        """
        found = (str(path or self._path), line, text)
        if found not in self._found:
            self._found.append(found)

    def __bool__(self) -> bool:
        return bool(self._found)

    def require_none(self) -> None:
        """See that there are none.

        Raises:
            GradingError: there are; with all of them, by file and line.
        """
        if not self._found:
            return
        told = [
            f"{path}, line {line}: {text}" if line else f"{path}: {text}" for path, line, text in sorted(self._found)
        ]
        if len(told) == 1:
            raise GradingError(told[0])
        raise GradingError("\n".join([f"{self._path} has {len(told)} mistakes.", *told]))

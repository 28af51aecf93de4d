"""How the kit starts, supervises and ends other processes; and what is closed at the end of a `with`."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self


class Closable(ABC):
    """Something with a `close`, which the end of a `with` calls."""

    @abstractmethod
    def close(self) -> None:
        """Let go of all it holds."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

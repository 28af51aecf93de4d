"""Verbs that must be awaited, and what a learner reads who forgot to.

Python says of a forgotten `await` that a coroutine has no attribute 'sum', or nothing at all. So these verbs return a
coroutine that says what is missing.
"""

from __future__ import annotations

import functools
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeVar

from course_kit.lab.errors import LabError

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from types import TracebackType

P = ParamSpec("P")
T = TypeVar("T")
UNAWAITED: dict[Pending[Any], None] = {}  # in the order of their calls; a cell that ends names its own
_KEPT = 1_000  # a program has no cell that ends
_PYTHONS_OWN = ("_", "cr_", "gi_", "ag_")  # what Python itself looks for on anything that may be a coroutine


class NotAwaitedError(LabError, AttributeError):
    """What a verb gives was used before the verb was awaited."""


class Pending(Coroutine[Any, Any, T]):
    """What a verb returns: it does its work when it is awaited, and until then says that it has not."""

    def __init__(self, make: Callable[[], Coroutine[Any, Any, T]], missing: str) -> None:
        self._make = make
        self._missing = missing
        self._running: Coroutine[Any, Any, T] | None = None
        if len(UNAWAITED) < _KEPT:
            UNAWAITED[self] = None

    def send(self, value: Any, /) -> Any:
        """As any coroutine's; a task of asyncio does it."""
        return self._begin().send(value)

    def throw(self, kind: Any, value: BaseException | object = None, traceback: TracebackType | None = None, /) -> Any:
        """As any coroutine's; a task of asyncio does it when it is cancelled."""
        del traceback  # one signature with three arguments is on its way out of Python
        return self._begin().throw(value if isinstance(value, BaseException) else kind)

    def close(self) -> None:
        """As any coroutine's: nobody will await it."""
        self._begin().close()

    def __await__(self) -> Generator[Any, Any, T]:
        """Do the work."""
        return self._begin().__await__()

    def __repr__(self) -> str:
        UNAWAITED.pop(self, None)  # it has said so now
        return self._missing

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith(_PYTHONS_OWN):
            raise AttributeError(name)
        self._complain()

    def _complain(self, *_: object) -> NoReturn:
        UNAWAITED.pop(self, None)
        raise NotAwaitedError(self._missing)

    __getitem__ = __iter__ = __aiter__ = _complain

    def _begin(self) -> Coroutine[Any, Any, T]:
        if self._running is None:
            UNAWAITED.pop(self, None)
            self._running = self._make()
        return self._running


def to_be_awaited(
    verb: str, otherwise: str = "Nothing was sent"
) -> Callable[[Callable[P, Coroutine[Any, Any, T]]], Callable[P, Pending[T]]]:
    """Have a coroutine function tell of a forgotten `await`."""

    def decorate(function: Callable[P, Coroutine[Any, Any, T]]) -> Callable[P, Pending[T]]:
        @functools.wraps(function)
        def call(*arguments: P.args, **options: P.kwargs) -> Pending[T]:
            return Pending(lambda: function(*arguments, **options), f"{otherwise}: write `await {verb}(...)`.")

        return call

    return decorate

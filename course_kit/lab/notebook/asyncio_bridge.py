"""`await client.call_async(request)` in a cell, without burning a core.

An rclpy future yields nothing to its event loop: asyncio resumes it over and over until it is done. Here a future
that is awaited while an asyncio loop runs wakes that loop when it is completed. Inside a callback there is no
asyncio loop, and rclpy's own way is kept.
"""

from __future__ import annotations

import asyncio
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from rclpy.task import Future

if TYPE_CHECKING:
    from collections.abc import Callable, Generator

    from course_kit.lab.overrides.patches import Patches


def as_asyncio(future: Future) -> asyncio.Future[Any]:
    """The running loop's future that follows an rclpy future; cancelling it cancels that one."""
    loop = asyncio.get_running_loop()
    follower = loop.create_future()

    def follow() -> None:
        if follower.done():
            return
        if future.cancelled():
            follower.cancel()
        elif future.exception() is not None:
            follower.set_exception(future.exception())
        else:
            follower.set_result(future.result())

    def completed(_: object) -> None:
        with suppress(RuntimeError):  # the loop is closed: nobody waits
            loop.call_soon_threadsafe(follow)

    def forward_cancel(waited: asyncio.Future[Any]) -> None:
        if waited.cancelled():
            future.cancel()

    future.add_done_callback(completed)
    follower.add_done_callback(forward_cancel)
    return follower


def install(patches: Patches, before_waiting: Callable[[Future], None], after_waiting: Callable[[], None]) -> None:
    """Replace `Future.__await__`."""
    original = Future.__await__

    def awaited(future: Future) -> Generator[Any, None, Any]:
        try:
            asyncio.get_running_loop()
        except RuntimeError:
            before_waiting(future)
            return (yield from original(future))
        try:
            return (yield from as_asyncio(future).__await__())
        finally:
            after_waiting()

    patches.set(Future, "__await__", awaited)

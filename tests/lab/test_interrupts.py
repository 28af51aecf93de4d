"""The Stop button ends a cell, whatever the cell waits for at that moment."""

from __future__ import annotations

import asyncio

import pytest
from std_msgs.msg import String

from course_kit import lab


@pytest.mark.usefixtures("own_lab")
def test_an_interrupt_that_comes_with_the_message_is_not_lost() -> None:
    """The message and the interrupt are in one round of the loop."""

    async def waited_for() -> None:
        waiting = asyncio.ensure_future(lab.next_messages("/words", String, 1))
        await asyncio.sleep(0)  # it has subscribed
        lab.publish("/words", String, data="word")  # returns when the subscription has had it; the loop stands
        asyncio.get_running_loop().call_soon(waiting.cancel)
        await waiting

    with pytest.raises(asyncio.CancelledError):
        asyncio.run(waited_for())

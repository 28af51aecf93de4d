"""Waiting until news on /parameter_events has come through."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from course_kit.lab.singleton import current

if TYPE_CHECKING:
    from rclpy.subscription import Subscription

_HEARING = 1.0  # seconds


class ParameterEventWait:
    """Waits for the lab's subscriptions to /parameter_events, so that what they print stands where it was caused."""

    def __init__(self) -> None:
        self._engine = current().engine
        self._counts: dict[Subscription, int] = {}
        self._expected = 0
        self._complete = threading.Event()

    def __enter__(self) -> ParameterEventWait:  # noqa: PYI034 - typing.Self is newer than Python 3.10
        from rcl_interfaces.msg import ParameterEvent

        if self._engine.tells_deliveries():
            self._counts = dict.fromkeys(self._engine.subscriptions("/parameter_events", ParameterEvent), 0)
        self._engine.listen_for_deliveries(self._heard, listen=True)
        return self

    def __exit__(self, *_: object) -> None:
        self._engine.listen_for_deliveries(self._heard, listen=False)
        self._engine.flush_output()

    def expects(self, count: int) -> bool:
        """Whether anybody has still to hear of so many changes."""
        self._expected = count
        return not self._all_heard()

    def wait(self) -> None:
        """Return when all have heard, or after a second."""
        if not self._all_heard():
            self._complete.wait(_HEARING)
        self._engine.flush_output()

    def _heard(self, subscription: Subscription) -> None:
        if subscription in self._counts:
            self._counts[subscription] += 1
            if self._expected and self._all_heard():
                self._complete.set()

    def _all_heard(self) -> bool:
        return all(count >= self._expected for count in self._counts.values())

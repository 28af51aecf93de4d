"""What crosses on the graph, as the recorder sees it, in portions that a page can follow."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, NamedTuple

from course_kit import lab
from course_kit.panels.base import Latest
from course_kit.ros.graph import CALLS, LISTENS, PUBLISHES, RUNS, SENDS_GOALS, SERVES, Role
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.lab.recording.events import Event


class Hop(NamedTuple):
    """One half of a message's way, between a node and a channel."""

    role: Role
    leaves: bool
    stage: int


_HOPS = {
    "published": Hop(PUBLISHES, leaves=True, stage=0),
    "received": Hop(LISTENS, leaves=False, stage=1),
    "request_sent": Hop(CALLS, leaves=True, stage=0),
    "request_received": Hop(SERVES, leaves=False, stage=1),
    "response_sent": Hop(SERVES, leaves=True, stage=2),
    "response_received": Hop(CALLS, leaves=False, stage=3),
    **dict.fromkeys(("goal_sent", "cancel_sent"), Hop(SENDS_GOALS, leaves=True, stage=0)),
    **dict.fromkeys(("goal_received", "cancel_received"), Hop(RUNS, leaves=False, stage=1)),
    **dict.fromkeys(
        ("goal_answered", "feedback_sent", "cancel_answered", "result_sent"), Hop(RUNS, leaves=True, stage=2)
    ),
    **dict.fromkeys(
        ("goal_answer_received", "feedback_received", "cancel_answer_received", "result_received"),
        Hop(SENDS_GOALS, leaves=False, stage=3),
    ),
}


class Traffic:
    """Tells `show` what has crossed since it was told last, ten times a second at most."""

    def __init__(self, show: Callable[[list[dict[str, object]]], None]) -> None:
        self._show = show
        self._lock = threading.Lock()
        self._crossed: dict[tuple[str, str, Hop], int] = {}
        self._updates: Latest[None] = Latest(lambda _: self._show_all())
        self._events = lab.current().events
        self._events.listen(self._observe)

    def close(self) -> None:
        """Listen no more."""
        self._events.ignore(self._observe)
        self._updates.close()

    def _observe(self, event: Event) -> None:
        hop = _HOPS.get(event.kind)
        if hop is None:
            return
        key = (event.node, event.channel, hop)
        with self._lock:
            self._crossed[key] = self._crossed.get(key, 0) + 1
        self._updates.put(None)

    def _show_all(self) -> None:
        with self._lock:
            crossed, self._crossed = self._crossed, {}
        told: list[dict[str, object]] = [
            {
                "node": short_name(node),
                "verb": hop.role.verb,
                "kind": hop.role.kind,
                "channel": channel,
                "leaves": hop.leaves,
                "stage": hop.stage,
                "count": count,
            }
            for (node, channel, hop), count in crossed.items()
        ]
        if told:
            self._show(told)

"""The robot of `delivery_robot` on its way along a corridor, drawn by what its nodes publish."""

from __future__ import annotations

import contextlib
import math
import threading
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from course_kit import lab
from course_kit.lab.topics import Subscription
from course_kit.panels.base import LatestValue, Panel, draw, of_files, still
from course_kit.panels.goal_panel import ENDED
from course_kit.ros import graph

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from course_kit.ros.messages import Message

_DOCK = "dock"
_CARRIER = "/carrier"
_LEFT, _LENGTH = 1.2, 9.6  # of the corridor, in the picture's own units
_NEAR_M = 0.1  # as near as that, the robot is there: so much a carrier's last feedback may leave


class Journey:
    """Where the robot is and how things stand there, as far as its nodes have said so."""

    def __init__(self) -> None:
        self.parameters: Mapping[str, Any] = {}  # of the carrier
        self.at: float | None = None  # metres from the dock
        self.target = ""
        self.door = "shut"  # or "asked", or "open", as far as the robot has asked
        self._goal = b""

    @property
    def rooms(self) -> dict[str, float]:
        """Metres from the dock, by the room's name; the dock comes first, alone while the carrier is being written."""
        names, metres = (self.parameters.get(name) for name in ("room_names", "room_distances_m"))
        found = zip(names, metres, strict=False) if isinstance(names, list) and isinstance(metres, list) else ()
        return {_DOCK: 0.0, **{room: far for room, far in found if isinstance(far, float) and 0.0 < far < math.inf}}

    def take_docked(self, message: Message) -> None:
        """The carrier says whether the robot stands at the dock, where the way begins."""
        self.at = 0.0 if message.data else self.at

    def take_feedback(self, message: Message) -> None:
        """A delivery goes on, whoever has sent it; how far it has to go says where to, and then where the robot is."""
        feedback, goal, here = message.feedback, bytes(message.goal_id.uuid), self.at
        self.door = "asked" if feedback.phase == feedback.DOOR else "open"
        if here is None:
            return
        rooms, left = self.rooms, feedback.distance_remaining
        if goal != self._goal:  # of two rooms the one farther from the dock: at the dock /docked says so
            self._goal = goal
            self.target = min(rooms, key=lambda room: (round(abs(abs(rooms[room] - here) - left), 2), -rooms[room]))
        there = rooms.get(self.target, here)
        self.at = there + math.copysign(left, here - there)

    def take_status(self, message: Message) -> None:
        """All goals of the carrier stand like this."""
        if all(goal.status >= goal.STATUS_SUCCEEDED for goal in message.status_list):
            self.target, self.door = "", self.door.replace("asked", "shut")

    def describe(self) -> str:
        """Where the robot is, and how the door, in two sentences."""
        if self.at is None:
            place = "has not been at the dock yet, where its way begins"
        elif self.target:
            place = f"is {self.at:.1f} m from the dock, on its way to {self.target}"
        else:
            near = [room for room, metres in self.rooms.items() if abs(metres - self.at) <= _NEAR_M]
            place = f"stands at {near[0]}" if near else f"stands {self.at:.1f} m from the dock"
        return f"The robot {place}. The door is {self.door.replace('asked', 'asked to open')}."


class _CorridorWidget(anywidget.AnyWidget):
    """The drawing, and below it a line in words."""

    _esm = of_files("dom.js", "corridor.js")
    _css = of_files("frame.css", "panels.css", "corridor.css")
    picture = traitlets.Unicode().tag(sync=True)
    line = traitlets.Unicode().tag(sync=True)


class CorridorPicture(Panel):
    """The corridor with dock, door and rooms, and the robot."""

    def __init__(self) -> None:
        super().__init__()
        from action_msgs.msg import GoalStatusArray
        from course_interfaces.action import Deliver
        from rcl_interfaces.msg import ParameterEvent
        from std_msgs.msg import Bool

        self._journey, self._lock = Journey(), threading.Lock()
        self._asked: set[str] = set()  # nodes whose parameters are known
        self.widget = _CorridorWidget()
        self.at_close(lambda: self.widget.set_trait("line", ENDED))
        self._updates: LatestValue[None] = LatestValue(lambda _: self._show())
        self.at_close(self._updates.close)
        self._hear("/parameter_events", ParameterEvent, lambda event: self._asked.discard(event.node))
        self._hear("/docked", Bool, self._journey.take_docked)
        self._hear("/deliver/_action/feedback", Deliver.Impl.FeedbackMessage, self._journey.take_feedback)
        self._hear("/deliver/_action/status", GoalStatusArray, self._journey.take_status)
        self._show()

    def describe(self) -> str:
        """The picture in words."""
        return "A corridor with a dock, a door and rooms, and the robot, where its nodes say that it is."

    def still(self) -> str:
        """The corridor as it is at this moment."""
        return still(f"{self.describe()}\n{self.widget.line}", self.widget.picture, "corridor.css")

    def _hear(self, topic: str, message_type: type[Message], take: Callable[[Message], None]) -> None:
        def keep(message: Message) -> None:
            with self._lock:
                take(message)
            self._updates.put(None)

        self.at_close(Subscription(lab.current().engine, topic, message_type, keep).close)

    def _show(self) -> None:
        with contextlib.suppress(lab.LabError):  # the carrier has gone, or is about to begin; or the lab has ended
            there = {_CARRIER}.intersection(graph.node_names(lab.current().engine.node))
            new, self._asked = there - self._asked, there  # a change meanwhile has it asked again
            if new:
                self._journey.parameters = lab.get_parameters_blocking(_CARRIER)
        with self._lock, self.widget.hold_sync():
            self.widget.picture, self.widget.line = self._draw(), self._journey.describe()

    def _draw(self) -> str:
        rooms = {room: metres for room, metres in self._journey.rooms.items() if room != _DOCK}
        door_at = (_LEFT + self._x(min(rooms.values(), default=math.inf))) / 2
        return draw("corridor.svg", journey=self._journey, rooms=rooms, door_at=door_at, x_of=self._x)

    def _x(self, metres: float) -> float:
        """Where metres from the dock are in the picture."""
        longest = max(self._journey.rooms.values()) or 1.0
        return round(_LEFT + _LENGTH * min(max(metres / longest, 0.0), 1.0), 2)

"""The robot of `delivery_robot` on its way along a corridor, drawn by what its nodes publish; a button sends it off."""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from course_kit import lab
from course_kit.lab.topics import Subscription
from course_kit.panels.base import draw, of_files, still
from course_kit.panels.goal_panel import GoalFollower, status_line
from course_kit.ros import graph
from course_kit.ros.parameters import from_message

if TYPE_CHECKING:
    from course_kit.panels.goal_panel import GoalState
    from course_kit.ros.messages import Message

_DOCK = "dock"
_ASKED_NODES = frozenset({"/carrier", "/door"})
_LEFT, _LENGTH = 1.2, 9.6  # of the corridor, in the picture's own units
_TOUCHES = 0.005  # metres; as near as that, the robot is there


class Journey:
    """Where the robot is and how things stand there, as far as its nodes have said so."""

    def __init__(self) -> None:
        self.parameters: dict[str, Any] = {}  # of all nodes, by name
        self.at: float | None = None  # metres from the dock
        self.target = ""
        self.door = "shut"  # or "asked", or "open"
        self.battery: float | None = None
        self.low = False
        self._driven = math.inf
        self._goal = b""

    @property
    def rooms(self) -> dict[str, float]:
        """Metres from the dock, by the room's name; the dock comes first."""
        names, metres = (self.parameters.get(name) for name in ("room_names", "room_distances_m"))
        if not isinstance(names, list) or not isinstance(metres, list):  # of a carrier that is being written
            return {_DOCK: 0.0}
        found = {str(room): value for room, value in zip(names, metres, strict=False) if isinstance(value, int | float)}
        return {_DOCK: 0.0, **{room: value for room, value in found.items() if 0.0 < value < math.inf}}

    @property
    def state_of_door(self) -> str:
        """In a word; whether it is shut or open shows only when the robot has asked."""
        return "locked" if self.parameters.get("locked") else self.door

    def take_docked(self, message: Message) -> None:
        """The carrier says whether the robot stands at the dock, where the way begins."""
        self.at = 0.0 if message.data else self.at

    def take_distance(self, message: Message) -> None:
        """The carrier says how far the robot has driven since its start: it is so much nearer to its target."""
        step, self._driven = message.data - self._driven, message.data
        if self.at is None or not step > 0:
            return
        way = self.rooms.get(self.target, math.inf) - self.at
        self.at += math.copysign(min(step, abs(way)), way)

    def take_battery(self, message: Message) -> None:
        """The battery says how full it is, and whether that is little."""
        self.battery = None if math.isnan(message.percentage) else min(max(message.percentage, 0.0), 1.0)
        self.low = message.power_supply_health == message.POWER_SUPPLY_HEALTH_DEAD

    def take_feedback(self, message: Message) -> None:
        """A delivery goes on, whoever has sent it; how far it has to go says where to."""
        feedback, goal = message.feedback, bytes(message.goal_id.uuid)
        self.door = "asked" if feedback.phase == feedback.DOOR else "open"
        if goal != self._goal and self.at is not None:
            left, here = feedback.distance_remaining, self.at
            self.target = min(self.rooms, key=lambda room: abs(abs(self.rooms[room] - here) - left))
        self._goal = goal

    def take_status(self, message: Message) -> None:
        """All goals of the carrier stand like this."""
        if all(goal.status >= goal.STATUS_SUCCEEDED for goal in message.status_list):
            self.target = ""
            self.door = "shut" if self.door == "asked" else self.door

    def describe(self) -> str:
        """Where the robot is, in sentences."""
        battery = "" if self.battery is None else f" The battery has {self.battery:.0%}{', low' * self.low}."
        door = self.state_of_door.replace("asked", "asked to open")
        return f"The robot {self._place()}. The door is {door}.{battery}"

    def _place(self) -> str:
        if self.at is None:
            return "has not been at the dock yet, where its way begins"
        if self.target and abs(self.rooms[self.target] - self.at) > _TOUCHES:
            return f"is {self.at:.1f} m from the dock, on its way to {self.target}"
        there = [room for room, metres in self.rooms.items() if abs(metres - self.at) <= _TOUCHES]
        return f"stands at {there[0]}" if there else f"stands {self.at:.1f} m from the dock"


class _CorridorWidget(anywidget.AnyWidget):
    """The drawing. It sends {"do": "go", "room"} and {"do": "cancel"}."""

    _esm = of_files("dom.js", "corridor.js")
    _css = of_files("frame.css", "panels.css", "corridor.css")
    rooms: traitlets.List[str] = traitlets.List().tag(sync=True)
    view = traitlets.Dict().tag(sync=True)


class CorridorPicture(GoalFollower):
    """The corridor with dock, door and rooms, the robot and its battery."""

    def __init__(self, action: str = "/deliver") -> None:
        super().__init__(action)
        from action_msgs.msg import GoalStatusArray
        from course_interfaces.action import Deliver
        from rcl_interfaces.msg import ParameterEvent
        from sensor_msgs.msg import BatteryState
        from std_msgs.msg import Bool, Float64

        self._journey = Journey()
        self.widget = _CorridorWidget()
        self._asked: set[str] = set()
        self._follow_goals(Deliver)
        self._hear("/parameter_events", ParameterEvent, self._take_event)
        self._hear("/docked", Bool, self._journey.take_docked)
        self._hear("/odometry_distance", Float64, self._journey.take_distance)
        self._hear("/battery", BatteryState, self._journey.take_battery)
        self._hear(f"{action}/_action/feedback", Deliver.Impl.FeedbackMessage, self._journey.take_feedback)
        self._hear(f"{action}/_action/status", GoalStatusArray, self._journey.take_status)

    def describe(self) -> str:
        """The picture in words."""
        return f"A corridor with a dock, a door and rooms, and the robot. Its buttons send goals to {self._action}."

    def still(self) -> str:
        """The corridor as it is at this moment."""
        with self._lock:
            picture, words = self._draw(), self._journey.describe()
        return still(f"{self.describe()}\n{words}", picture, "corridor.css")

    def _hear(self, topic: str, message_type: type[Message], take: Any) -> None:
        def keep(message: Message) -> None:
            with self._lock:
                take(message)
            self._updates.put(self._standing)

        self.at_close(Subscription(lab.current().engine, topic, message_type, keep).close)

    def _ask_who_is_new(self) -> None:
        """A node tells its parameters when it begins, often before anybody can hear it."""
        with contextlib.suppress(lab.LabError):  # a node has gone, or is about to begin; or the lab is about to end
            there = _ASKED_NODES.intersection(graph.node_names(lab.current().engine.node))
            self._asked &= there
            for node in there - self._asked:
                values = lab.get_parameters_blocking(node)
                self._asked.add(node)
                with self._lock:
                    self._journey.parameters.update(values)

    def _take_event(self, event: Message) -> None:
        if event.node in _ASKED_NODES:
            changed = (*event.new_parameters, *event.changed_parameters)
            self._journey.parameters.update({parameter.name: from_message(parameter.value) for parameter in changed})

    def _take_wish(self, wish: dict[str, Any]) -> None:
        self.send_to_one(self._action_type.Goal(room=str(wish.get("room", ""))))

    def _show(self, standing: GoalState) -> None:
        if not self._ended:
            self._ask_who_is_new()
        text = status_line(standing, f'The delivery to "{standing.asked.room}"' if standing.asked is not None else "")
        if standing.result is not None and standing.result.message:
            text += f" Its message: {standing.result.message}."
        with self._lock:
            picture, words, target = self._draw(), self._journey.describe(), self._journey.target
            self.widget.rooms = list(self._journey.rooms)
        own = text if standing.is_running or not target else ""  # somebody else has sent it off since
        self.widget.view = {"picture": picture, **self._describe_goal(standing, f"{own} {words}".strip(), text)}

    def _draw(self) -> str:
        rooms = {room: metres for room, metres in self._journey.rooms.items() if room != _DOCK}
        door_at = (_LEFT + self._x(min(rooms.values(), default=math.inf))) / 2
        return draw("corridor.svg", journey=self._journey, rooms=rooms, door_at=door_at, x_of=self._x)

    def _x(self, metres: float) -> float:
        """Where metres from the dock are in the picture."""
        longest = max(self._journey.rooms.values()) or 1.0
        return round(_LEFT + _LENGTH * min(max(metres / longest, 0.0), 1.0), 2)

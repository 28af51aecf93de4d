"""A map of exercise 2's arena: a click sends the robot there, as a real goal, and its feedback draws the way."""

from __future__ import annotations

import math
from collections import deque
from typing import TYPE_CHECKING, Any, NamedTuple

import anywidget
import traitlets

from course_kit import lab
from course_kit.lab.runtime.describe import actions_of
from course_kit.panels import goal_panel
from course_kit.panels.base import draw, of_files, still
from course_kit.panels.goal_panel import GoalFollower
from course_kit.robot import SimulatedRobot
from course_kit.ros import graph
from course_kit.ros.messages import type_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.lab.recording.events import Event
    from course_kit.panels.goal_panel import GoalState
    from course_kit.robot import Position
    from course_kit.ros.messages import Message

LONGEST = 1000  # places; the oldest go first


class Place(NamedTuple):
    """A point of the arena, in metres."""

    x: float
    y: float


class _MapWidget(anywidget.AnyWidget):
    """The drawing. Python sends it `view`; it sends {"do": "go", "x", "y"} and {"do": "cancel"}."""

    _esm = of_files("arena_map.js")
    _css = of_files("frame.css", "panels.css", "arena_map.css")
    size = traitlets.Float(SimulatedRobot.ARENA_SIZE).tag(sync=True)
    view = traitlets.Dict().tag(sync=True)


class RobotMap(GoalFollower):
    """The arena of `course_interfaces/action/MoveRobot`, 10 m x 10 m, and what its feedback says about the robot."""

    def __init__(self, action: str = "/move_robot") -> None:
        super().__init__(action)
        from course_interfaces.action import MoveRobot

        self._type = MoveRobot
        self._track: deque[Place] = deque(maxlen=LONGEST)
        self._drawn: Message | None = None  # the result whose place stands on the track
        if (robot := self._find_robot()) is not None:
            self._drive_to(robot.position)
        self.widget = _MapWidget()
        self._follow_goals(MoveRobot)
        events = lab.current().events
        events.listen(self._observe)
        self.at_close(lambda: events.ignore(self._observe))

    def describe(self) -> str:
        """The panel in words."""
        return (
            f"A map of the arena, {SimulatedRobot.ARENA_SIZE:g} m by {SimulatedRobot.ARENA_SIZE:g} m. "
            f"A click on it sends a goal to {self._action}."
        )

    def still(self) -> str:
        """The arena, and what is known of the robot at this moment."""
        view = self.widget.view
        known = {"track": view["track"], "target": view["target"]}
        summary = " ".join(["Map of the arena.", view["said"]]).strip()
        picture = draw("still_map.svg", size=round(SimulatedRobot.ARENA_SIZE), summary=summary, **known)
        return still(self.describe(), picture, "still_drawings.css")

    def go(self, x: float, y: float) -> None:
        """Send the robot to (x, y), in metres, unless several would go; returns at once. What a click does."""
        from geometry_msgs.msg import Point

        servers = graph.count_servers(lab.current().engine.node, "action", self._action)
        if servers > 1:
            self.say(
                f"Not sent: {servers} nodes offer {self._action}, and each would drive its own robot. "
                "Stop all but one: panels.graph() shows them, and lab.stop_others() stops those of other notebooks."
            )
        else:
            self.send_goal(self._type.Goal(target=Point(x=float(x), y=float(y))))

    def _take_wish(self, wish: dict[str, Any]) -> None:
        if isinstance(wish.get("x"), int | float) and isinstance(wish.get("y"), int | float):
            self.go(wish["x"], wish["y"])
        else:
            self.say("Type a number for x and one for y.")

    def _take_feedback(self, feedback: Message) -> None:
        self._drive_to(feedback.position)

    def _observe(self, event: Event) -> None:
        """Draw where a goal that was not sent from here takes a robot of this lab."""
        sent = (event.kind, event.channel, event.type_name) == ("feedback_sent", self._action, type_name(self._type))
        with self._lock:
            if sent and not self._standing.is_running:
                self._drive_to(Place(event.value["position"]["x"], event.value["position"]["y"]))
                self._put(self._standing)

    def _find_robot(self) -> SimulatedRobot | None:
        """The robot that the action drives, where its node runs in this lab."""
        nodes = [live.node for live in lab.current().live_nodes() if self._action in actions_of(live.node)]
        found = [one for node in nodes for one in vars(node).values() if isinstance(one, SimulatedRobot)]
        return found[0] if len(found) == 1 else None

    def _drive_to(self, point: Message | Position | Place) -> None:
        """Go on to a point, to the centimetre, which is more than the map can show."""
        if math.isfinite(point.x) and math.isfinite(point.y):
            place = Place(round(point.x, 2), round(point.y, 2))
            if not self._track or place != self._track[-1]:
                self._track.append(place)

    def _show(self, standing: GoalState) -> None:
        if standing.result is not None and standing.result is not self._drawn:  # others may drive on
            self._drawn = standing.result
            self._drive_to(standing.result.final_position)
        self.widget.view = {
            "track": [list(place) for place in list(self._track)],
            "target": [] if standing.asked is None else [standing.asked.target.x, standing.asked.target.y],
            "line": goal_panel.ENDED if self._ended else _line(self._action, standing, self._track),
            "said": _describe_goal(standing),  # when something has happened
            "running": standing.is_running and not self._ended,
            "tone": standing.tone,
            "ended": self._ended,
        }


def _line(action: str, standing: GoalState, track: Sequence[Place]) -> str:
    """Position, distance left and status, for those who see the map and those who do not."""
    if standing.asked is None and not standing.note:
        unknown = "The map shows where the robot is as soon as it sends feedback."
        where = f"The robot was last seen at {_place(track[-1])}." if track else unknown
        return f"Click on the map, or type x and y and press Go: that sends a goal to {action}. {where}"
    parts = [_describe_goal(standing)]
    if standing.result is not None:
        parts.append(f"The robot came to {_place(standing.result.final_position)}.")
        if standing.result.message:
            parts.append(f"Its message: {standing.result.message}.")
    elif standing.is_running and standing.feedback is not None:
        feedback = standing.feedback
        parts.append(f"Position {_place(feedback.position)}, {feedback.distance_remaining:.2f} m to go.")
    return " ".join(parts)


def _describe_goal(standing: GoalState) -> str:
    """The status in words; it changes when something happens, not with each metre."""
    goal = f"The goal {_place(standing.asked.target)}" if standing.asked is not None else ""
    return goal_panel.status_line(standing, goal, _refusal(standing) if standing.refused is not None else "")


def _refusal(standing: GoalState) -> str:
    """Why a goal may have been rejected; the server's answer is a mere no."""
    target = standing.refused.target
    size = SimulatedRobot.ARENA_SIZE
    begin = goal_panel.status("REJECTED", f"The goal {_place(target)}") if standing.is_running else ""
    if not (0.0 <= target.x <= size and 0.0 <= target.y <= size):
        why = f"It lies outside the arena, which goes from 0 to {size:g} m."
    elif standing.is_running:
        why = "The robot is busy: one goal at a time."
    else:
        why = "A rejection comes without a reason; perhaps somebody else has sent the robot somewhere."
    return f"{begin} {why}".strip()


def _place(point: Message | Place) -> str:
    return f"({point.x:.1f}, {point.y:.1f})"

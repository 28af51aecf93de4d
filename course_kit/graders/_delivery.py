"""The steps of the capstone's checks: what is started, what the robot is sent for, and what has to come of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_interfaces.action import Deliver
from sensor_msgs.msg import BatteryState
from std_srvs.srv import SetBool

from course_kit.grading.checks import discovery, hangs
from course_kit.grading.checks.answers import are_same, describe_value
from course_kit.grading.checks.evidence import in_one_line
from course_kit.grading.checks.graded_goal import SUCCEEDED
from course_kit.grading.checks.vocabulary import Approximation, Evidence, Failed, GradedGoal, GradedNode, offer_service

if TYPE_CHECKING:
    from course_kit.ros.messages import Message

STATE, DISTANCE, DOCKED, OPEN, DELIVER = "/battery", "/odometry_distance", "/docked", "/door/open", "/deliver"
DOOR, DRIVING = Deliver.Feedback.DOOR, Deliver.Feedback.DRIVING
LOW, GOOD = BatteryState.POWER_SUPPLY_HEALTH_DEAD, BatteryState.POWER_SUPPLY_HEALTH_GOOD
CHARGING, DISCHARGING = BatteryState.POWER_SUPPLY_STATUS_CHARGING, BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
ROOMS = {"attic": 0.9, "cellar": 0.8, "gate": 0.0, "hall": 0.1, "lab": 1.0, "tower": 30.0}  # m; the tower is too far
PLACES = {**ROOMS, "shed": 1.4, "dock": 0.0}
ALONE_MPS, SLOW_MPS, CREEP_MPS, FAST_MPS = 2.0, 1.0, 0.2, 40.0
BUILDING = {"room_names": list(ROOMS), "room_distances_m": list(ROOMS.values()), "speed_mps": ALONE_MPS}
CHARGE, LESS = 0.75, 0.5  # what the carrier hears
SHOWN_S, CALM_S, PATIENCE_S = 1.2, 0.1, 3.0  # what has to happen within a second; what must not; and anything else
GIVES_UP_S = 2.0 + CALM_S  # after door_timeout_s
CLOSE, NEAR_M, END_M = 1e-3, 0.05, 0.1  # of a percentage, which is a float32; of metres, as the text says


def require(right: object, evidence: Evidence, why: str, code: str | None = None) -> None:
    """Something is right; else that is what was seen, and why it is wrong."""
    if not right:
        raise Failed(evidence, why, code)


def have_running(node: GradedNode, program: str, *arguments: str, **parameters: Any) -> None:
    """Have a program running, started with these arguments and parameters."""
    wanted, memory = (program, arguments, parameters), node.context.memory
    if node.context.spoiled or memory.get("runs") != wanted:
        node.start(*arguments, program=program, parameters=parameters)
        memory.update(runs=wanted, at=0.0, driven=0.0)
        node.prepare()


def require_graph(
    node: GradedNode, wanted: dict[str, dict[str, Any]], why: str = "", code: str | None = "parameter.default"
) -> None:
    """These nodes are there, with all that exercise.toml names, and their parameters have these types and values."""
    for name in wanted:
        node.parameters(name).expect_served()
    discovery.expect_endpoints(node.context, node.endpoints)
    for name, values in wanted.items():
        node.parameters(name).expect_declared(values, why, code)


def expect_soon(node: GradedNode, topic: str, why: str, **wanted: Any) -> None:
    """A message with these fields comes within a second, or a moment later."""
    inbox, context = node.inbox(topic), node.context
    place = inbox.count
    found = context.wait_until(lambda: any(are_same(wanted, one) for one in inbox.newer_than(place)), SHOWN_S)
    seen = inbox.newer_than(place)
    evidence = Evidence(context.record.last_exchange()[0], f"{topic}: {describe_value(wanted)}", f"nothing on {topic}")
    require(seen, evidence, f"Nothing was published on {topic} for a second.", "topic.silent")
    require(found, replace(evidence, got=f"{topic}: {in_one_line(seen[-1])}"), why)


# --- the battery


def drive_so_far(node: GradedNode, metres: float, falls: float, why: str) -> None:
    """A carrier says that it has driven so far in all; then the battery is as empty as that makes it."""
    memory = node.context.memory
    charge = memory["charge"] = max(memory.get("charge", 1.0) - falls, 0.0)
    node.send(DISTANCE, data=metres)
    expect_soon(node, STATE, why, percentage=Approximation(charge, absolute=CLOSE))


# --- the carrier


def enter(node: GradedNode) -> None:
    """Have the carrier alone, in a building of ours whose door opens at once, with a battery that is not low."""
    have_running(node, "carrier.py", **BUILDING, door_timeout_s=PATIENCE_S)
    open_door(node)
    node.send(STATE, percentage=CHARGE, power_supply_health=GOOD)
    node.context.wait_until(lambda: node.context.grader_node.node.count_clients(OPEN) > 0, CALM_S)
    hangs.greet_node(node.context)  # then it knows our door, too


def expect_distance(node: GradedNode) -> None:
    """The carrier says how far it has driven in all."""
    driven = Approximation(node.context.memory["driven"], absolute=NEAR_M)
    expect_soon(node, DISTANCE, f"{DISTANCE} does not match the distances in the results of the goals.", data=driven)


def ask_for_delivery(node: GradedNode, room: str) -> GradedGoal:
    """A goal that is accepted; the carrier asks for the door, which says nothing as long as nobody replies."""
    door = offer_service(node, OPEN, SetBool)
    before = len(door.requests)
    goal = node.goal(DELIVER, room=room).accepted_by()
    asked = node.context.wait_until(lambda: any(request.data for request in list(door.requests)[before:]), PATIENCE_S)
    if not asked and goal.over_at is not None:  # how it has ended says more
        goal.ends()
    evidence = Evidence(goal.shown, f"a request for {OPEN} with data=true", "none")
    require(asked, evidence, "The node carrier did not ask for the door.")
    return goal


def open_door(node: GradedNode) -> None:
    """The door opens, for those who wait and for the next."""
    door = offer_service(node, OPEN, SetBool, success=True, message="open")
    door.reply(door.answer)


def wait_until_driving(node: GradedNode, goal: GradedGoal, messages: int = 1) -> None:
    """Wait until so many messages of feedback say that the robot drives."""
    node.context.wait_until(lambda: sum(one.feedback.phase == DRIVING for one in goal.feedback) >= messages, PATIENCE_S)


def deliver(node: GradedNode, room: str, speed_mps: float = ALONE_MPS, goal: GradedGoal | None = None) -> None:
    """The door opens, and a goal, or this one, ends SUCCEEDED, after as long as the way takes."""
    memory, opened = node.context.memory, node.context.clock()
    open_door(node)
    goal = goal or node.goal(DELIVER, room=room).accepted_by()
    metres = abs(PLACES[room] - memory["at"])
    driven = Approximation(metres, absolute=NEAR_M)
    ended = goal.ends(within_s=2.0 * metres / speed_mps + SHOWN_S, delivered=True, distance=driven)
    took_s = opened.wall_s()
    evidence = Evidence(goal.shown, f"{metres:.2f} m in {metres / speed_mps:.2f} s or more", f"{took_s:.2f} s")
    require(took_s >= 0.9 * metres / speed_mps, evidence, f"That is faster than speed_mps={speed_mps:g}.")
    memory.update(at=PLACES[room], driven=memory["driven"] + ended.result.distance)


def require_stop(node: GradedNode, goal: GradedGoal, speed_mps: float) -> float:
    """A goal is cancelled in time, after no more metres than its speed allows; returns how many."""
    ended = goal.cancelled().ends("CANCELED", within_s=SHOWN_S, delivered=False)
    metres, most = float(ended.result.distance), speed_mps * goal.clock.wall_s() + NEAR_M
    evidence = Evidence(goal.shown, f"distance <= {most:.2f}, at {speed_mps:g} m/s", f"distance={metres:.2f}")
    why = "distance is what the robot drove for this goal; a change of speed_mps counts from the next goal on."
    require(0.0 <= metres <= most, evidence, why)
    node.context.memory["driven"] += metres
    return metres


def require_aborted(goal: GradedGoal, within_s: float, words: str = "", after_s: float = 0.0) -> None:
    """A goal ends ABORTED in time, with a message in which these words stand; the robot has not moved."""
    stood = Approximation(0.0, absolute=NEAR_M)
    ended = goal.ends("ABORTED", within_s=within_s, not_before_s=after_s, delivered=False, distance=stood)
    said = ended.result.message
    evidence = Evidence(goal.shown, f"a message that contains {words or 'something'!r}", f"message={said!r}")
    require(said.strip() and words in said, evidence, "The message has to say why the parcel was not delivered.")


def require_one(node: GradedNode, first: GradedGoal, second: GradedGoal) -> GradedGoal:
    """Of two goals only one is accepted, which is returned, unless the first is over before the second begins."""
    for goal in (first, second):
        goal.wait_for_answer("one of two goals accepted")
    node.context.wait_until(lambda: bool(second.statuses) or not second.accepted, SHOWN_S)
    both = first.accepted and second.accepted and not (first.over_at and first.over_at <= second.began_at)
    evidence = Evidence(f"{first.shown}; meanwhile {second.shown}", "one of two goals accepted", "both accepted")
    require(not both, evidence, "There is only one robot: reject the second goal.", "action.concurrent_goals")
    return second if second.accepted else first.accepted_by()


def finish(node: GradedNode, goal: GradedGoal, room: str, seconds: float) -> Message:
    """A goal that was accepted ends, however; then the robot is where it was sent."""
    ended, memory = goal.wait_for_end(seconds, "SUCCEEDED"), node.context.memory
    memory.update(at=PLACES.get(room, 0.0), driven=memory["driven"] + ended.result.distance)
    return ended


def send_until(node: GradedNode, room: str, outcome: str = "accepted", seconds: float = SHOWN_S) -> GradedGoal:
    """Send goals until one is accepted, rejected or delivered, for so many seconds: a carrier hears late of others."""
    clock = node.context.clock()
    while True:
        late, goal = clock.has_passed(seconds), node.goal(DELIVER, room=room)
        accepted = goal.wait_for_answer(f"the goal {outcome}")
        is_right = accepted == (outcome != "rejected")
        if accepted and outcome != "accepted":
            is_right &= finish(node, goal, room, seconds + PATIENCE_S).status == SUCCEEDED
        if is_right or late:
            return goal
        node.wait(CALM_S)


def deliver_at_door(node: GradedNode) -> GradedGoal:
    """A delivery that waits for a door which opens slowly."""
    node.set({"opening_s": 5.0}, of="/door").accepted()
    goal = send_until(node, "kitchen").accepted_by()
    node.wait(2.0 * CALM_S)
    return goal

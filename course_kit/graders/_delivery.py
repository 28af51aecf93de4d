"""The steps of the capstone's checks: what is started, what the robot is sent for, and what has to come of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_interfaces.action import Deliver
from sensor_msgs.msg import BatteryState
from std_srvs.srv import SetBool

from course_kit.grading.checks import discovery, hangs
from course_kit.grading.checks.answers import describe_wanted, differences
from course_kit.grading.checks.exchange_log import in_one_line
from course_kit.grading.checks.graded_goal import ABORTED, SUCCEEDED
from course_kit.grading.checks.parameters import describe_values
from course_kit.grading.checks.vocabulary import Approximation, Evidence, Failed, GradedGoal, GradedNode, offer_service
from course_kit.ros.parameters import NOT_SET

if TYPE_CHECKING:
    from course_kit.grading.checks.graded_goal import GoalOutcome
    from course_kit.grading.checks.grader_node import OfferedService

STATE, DISTANCE, DOCKED, OPEN, DELIVER = "/battery", "/odometry_distance", "/docked", "/door/open", "/deliver"
DOOR, DRIVING = Deliver.Feedback.DOOR, Deliver.Feedback.DRIVING
LOW, GOOD = BatteryState.POWER_SUPPLY_HEALTH_DEAD, BatteryState.POWER_SUPPLY_HEALTH_GOOD
CHARGING, DISCHARGING = BatteryState.POWER_SUPPLY_STATUS_CHARGING, BatteryState.POWER_SUPPLY_STATUS_DISCHARGING
ROOMS = {"attic": 0.9, "cellar": 0.8, "hall": 0.1, "tower": 30.0}  # metres; nobody waits until the tower is reached
PLACES = {**ROOMS, "shed": 1.1, "dock": 0.0}
ALONE_MPS, SLOW_MPS = 2.0, 0.5
BUILDING = {"room_names": list(ROOMS), "room_distances_m": list(ROOMS.values()), "speed_mps": ALONE_MPS}
CHARGE = 0.75  # that the carrier is told
SHOWN_S, CALM_S, PATIENCE_S = 1.2, 0.1, 3.0  # what has to happen within a second; what must not; and anything else
GIVES_UP_S = 2.0 + CALM_S  # after door_timeout_s
CLOSE, NEAR_M, END_M = 1e-3, 0.05, 0.1  # of a percentage, which is a float32; of metres, as the text says


def require(right: object, evidence: Evidence, why: str, code: str | None = None) -> None:
    """Something is right; else that is what was seen, and why it is wrong."""
    if not right:
        raise Failed(evidence, why, code)


def have_running(node: GradedNode, program: str, *arguments: str, **parameters: Any) -> bool:
    """Have a program running, started with these arguments and parameters; whether it was started now."""
    wanted, memory = (program, arguments, parameters), node.context.memory
    if not node.context.spoiled and memory.get("runs") == wanted:
        return False
    node.start(*arguments, program=program, parameters=parameters, meets=False)
    memory.update(runs=wanted, at=0.0, driven=0.0)
    node.prepare()
    return True


def require_graph(node: GradedNode, wanted: dict[str, dict[str, Any]]) -> None:
    """These nodes are there, with all that exercise.toml names, and their parameters have these types and values."""
    for name in wanted:
        node.parameters(name).expect_served()
    discovery.expect_endpoints(node.context, node.endpoints)
    node.ensure_running()
    for name, values in wanted.items():
        found = node.parameters(name).values(list(values))
        read = {key: setting.value for key, setting in found.items()}
        evidence = Evidence(f"get_parameters of {name}", describe_values(values), describe_values(read))
        for key, value in values.items():
            kind = found[key].type
            require(kind != NOT_SET, evidence, f"The node {name} has not declared {key}.", "parameter.undeclared")
            same = type(read[key]) is type(value)
            require(same, evidence, f"The parameter {key} of {name} has the type {kind}.", "parameter.type")
            require(read[key] == value, evidence, f"{key} of {name} is {read[key]!r}.", "parameter.default")


def wait_in_vain(node: GradedNode) -> None:
    """Wait for what must not happen."""
    node.context.wait_until(lambda: False, CALM_S)


# --- the battery


def expect_state(node: GradedNode, why: str, **wanted: Any) -> float:
    """A message with these fields comes on /battery within a second; its percentage is returned."""
    inbox, context = node.inbox(STATE), node.context
    place = inbox.count

    def find_fitting_messages() -> list[Any]:
        return [message for message in inbox.newer_than(place) if not list(differences(wanted, message))]

    context.wait_until(lambda: bool(find_fitting_messages()), SHOWN_S)
    seen = inbox.newer_than(place)
    sent, expected = context.record.last_exchange()[0], f"{STATE}: {describe_wanted(wanted)}"
    silent = f"The node battery published nothing on {STATE} for a second."
    require(seen, Evidence(sent, expected, f"nothing on {STATE}"), silent, "topic.silent")
    in_range = all(-CLOSE < state.percentage < 1.0 + CLOSE for state in seen)
    require(find_fitting_messages() and in_range, Evidence(sent, expected, f"{STATE}: {in_one_line(seen[-1])}"), why)
    return float(find_fitting_messages()[0].percentage)


def drive_so_far(node: GradedNode, metres: float, falls: float, why: str) -> None:
    """A carrier says that it has driven so far in all; then the battery is as empty as that makes it."""
    memory = node.context.memory
    charge = memory["charge"] = max(memory.get("charge", 1.0) - falls, 0.0)
    node.send(DISTANCE, data=metres)
    expect_state(node, why, percentage=Approximation(charge, absolute=CLOSE))


# --- the carrier


def enter(node: GradedNode, door_timeout_s: float = PATIENCE_S) -> OfferedService:
    """Have the carrier alone, in a building of ours whose door opens at once, with a battery that is not low."""
    fresh = have_running(node, "carrier.py", **BUILDING, door_timeout_s=door_timeout_s)
    door = offer_service(node, OPEN, SetBool, success=True, message="open")
    if fresh:
        node.ensure_running()
        node.context.wait_until(lambda: node.context.grader_node.node.count_clients(OPEN) > 0, CALM_S)
        hangs.greet_node(node.context)  # then it knows our door, too
        tell_battery(node, GOOD)
    return door


def tell_battery(node: GradedNode, health: int) -> None:
    """Be the battery."""
    node.send(STATE, percentage=CHARGE, power_supply_health=health)


def ask_for_delivery(node: GradedNode, room: str, door: OfferedService) -> GradedGoal:
    """A goal that is accepted; the carrier asks for the door, which says nothing as long as nobody replies."""
    before, door.answer = len(door.requests), None
    goal = node.goal(DELIVER, room=room).accepted_by()
    asked = node.context.wait_until(lambda: any(request.data for request in list(door.requests)[before:]), PATIENCE_S)
    evidence = Evidence(goal.shown, f"a request for {OPEN} with data=true", "none")
    require(asked, evidence, "The node carrier did not ask for the door.")
    return goal


def open_door(node: GradedNode) -> None:
    """The door opens, for those who wait and for the next."""
    door = offer_service(node, OPEN, SetBool, success=True, message="open")
    node.context.memory["opened"] = node.context.clock()
    door.reply(door.answer)


def require_arrival(node: GradedNode, goal: GradedGoal, room: str, speed_mps: float = ALONE_MPS) -> None:
    """A goal for which the door is open ends SUCCEEDED, after as long as the way takes."""
    memory = node.context.memory
    metres = abs(PLACES[room] - memory["at"])
    ended = goal.ends("SUCCEEDED", within_s=2.0 * metres / speed_mps + SHOWN_S, delivered=True)
    took_s = min(goal.clock.wall_s(), memory.get("opened", goal.clock).wall_s())
    evidence = Evidence(goal.shown, f"{metres:.2f} m in {metres / speed_mps:.2f} s or more", f"{took_s:.2f} s")
    require(took_s >= 0.9 * metres / speed_mps, evidence, f"That is faster than speed_mps={speed_mps:g}.")
    require_distance(node, goal, ended, metres)
    memory["at"] = PLACES[room]


def require_distance(node: GradedNode, goal: GradedGoal, ended: GoalOutcome, metres: float) -> None:
    """The result says that so many metres were driven for this goal."""
    node.context.memory["driven"] += (driven_m := ended.result.distance)
    evidence = Evidence(goal.shown, f"distance={metres:.2f}, within 0.05", f"distance={driven_m:.3f}")
    require(abs(driven_m - metres) <= NEAR_M, evidence, "The robot drove a different distance for this goal.")


def deliver(node: GradedNode, room: str) -> GradedGoal:
    """A delivery while the door opens at once."""
    goal = node.goal(DELIVER, room=room).accepted_by()
    require_arrival(node, goal, room)
    return goal


def require_aborted(node: GradedNode, goal: GradedGoal, within_s: float, words: str = "", after_s: float = 0.0) -> None:
    """A goal ends ABORTED in time, with a message in which these words stand; the robot has not moved."""
    expected = f"ABORTED, delivered=False, with a message{f' that contains {words!r}' if words else ''}"
    ended = goal.wait_for_end(within_s, expected)
    result, took_s = ended.result, goal.clock.wall_s()
    evidence = Evidence(goal.shown, expected, f"{ended.name} after {took_s:.2f} s, {in_one_line(result)}")
    goal.require_status(ended, ABORTED, evidence)
    require(took_s >= after_s, evidence, f"The carrier gave up before {after_s:g} s had passed.")
    right = not result.delivered and result.message.strip() and words in result.message
    require(right, evidence, "The result has to say whether the parcel arrived and, if not, why.")
    require_distance(node, goal, ended, 0.0)


def require_said(node: GradedNode, goal: GradedGoal, topic: str, wanted: float) -> None:
    """What comes on a topic becomes right within half a second, or a moment later."""
    inbox = node.inbox(topic)
    place = inbox.count
    node.context.wait_until(lambda: any(abs(seen.data - wanted) < NEAR_M for seen in inbox.newer_than(place)), SHOWN_S)
    got = [seen.data for seen in inbox.newer_than(place)[-1:]]
    evidence = Evidence(goal.shown, f"{topic}: {wanted:.2f}", f"{topic}: {got or 'nothing'}")
    require(got and abs(got[0] - wanted) < NEAR_M, evidence, f"{topic} says something else than the results of goals.")


def require_one(node: GradedNode, first: GradedGoal, second: GradedGoal) -> GradedGoal:
    """Of two goals only one is accepted, which is returned, unless the first is over before the second begins."""
    for goal in (first, second):
        goal.wait_for_answer("one of two goals accepted")
    node.context.wait_until(lambda: bool(second.statuses) or not second.accepted, SHOWN_S)
    both = first.accepted and second.accepted and not (first.over_at and first.over_at <= second.began_at)
    evidence = Evidence(f"{first.shown}; meanwhile {second.shown}", "one of two goals accepted", "both accepted")
    require(not both, evidence, "There is only one robot: reject the second goal.", "action.concurrent_goals")
    return second if second.accepted else first.accepted_by()


def require_some_delivery(node: GradedNode, room: str, seconds: float) -> None:
    """A delivery succeeds within so many seconds, if not the first then another one."""
    clock, memory = node.context.clock(), node.context.memory
    while True:
        late, goal = clock.has_passed(seconds), node.goal(DELIVER, room=room)
        goal.wait_for_answer("the goal accepted")
        if goal.accepted:
            ended = goal.wait_for_end(seconds + PATIENCE_S, "SUCCEEDED")
            memory["driven"] += ended.result.distance
            memory["at"] = PLACES.get(room, 0.0)
            if ended.status == SUCCEEDED:
                return
        if late:
            goal.accepted_by().ends(within_s=PATIENCE_S)
        wait_in_vain(node)


def deliver_at_door(node: GradedNode) -> GradedGoal:
    """A delivery that waits for a door which opens slowly."""
    node.set({"opening_s": 5.0}, of="/door").accepted()
    clock = node.context.clock()
    while (goal := node.goal(DELIVER, room="kitchen")) and not clock.has_passed(SHOWN_S):
        goal.wait_for_answer("the goal accepted")
        if goal.accepted:  # else the carrier has not heard yet that the battery is not low any more
            break
    node.context.wait_until(lambda: bool(goal.accepted_by().feedback), SHOWN_S)
    wait_in_vain(node)
    return goal

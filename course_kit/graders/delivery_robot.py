"""The capstone: three programs, each alone, the grader in place of the others; then the graph of the launch file."""

from __future__ import annotations

import functools
from math import inf, nan
from typing import Any

from std_srvs.srv import SetBool

from course_kit.graders import _delivery as robot
from course_kit.graders._delivery import CALM_S, CLOSE, DELIVER, DISTANCE, DOCKED, OPEN, PATIENCE_S, SHOWN_S, STATE
from course_kit.grading.checks.evidence import in_one_line
from course_kit.grading.checks.ready_made import expect_rate
from course_kit.grading.checks.vocabulary import Approximation, Evidence, GradedNode, check, offer_service

SPEED = 4.5  # m/s, by the launch argument
LAUNCH = ("delivery.launch.py", f"speed:={SPEED}")
LAUNCHED: dict[str, dict[str, Any]] = {  # as the text wants it in robot.yaml
    "/battery": {"capacity_m": 20.0, "publish_hz": 10.0, "low_fraction": 0.2},
    "/door": {"locked": False, "opening_s": 0.3},
    "/carrier": {"room_names": ["kitchen", "office", "lab"], "room_distances_m": [0.4, 0.8, 1.0],
                 "door_timeout_s": 2.0, "speed_mps": SPEED},
}  # fmt: skip
INVALID = {"capacity_m": (0.0, -1.0, nan, inf), "publish_hz": (0.9995, 50.01, nan), "low_fraction": (-0.001, 1.0005)}
VALID = (("low_fraction", 0.0), ("low_fraction", 1.0), ("publish_hz", 1.0), ("publish_hz", 50.0))
on_battery = functools.partial(check, deadline_s=25.0, begin=lambda node: robot.have_running(node, "battery.py"))
on_door = functools.partial(check, deadline_s=25.0, begin=lambda node: robot.have_running(node, "door.py"))
on_carrier = functools.partial(check, deadline_s=25.0, begin=robot.enter)
on_robot = functools.partial(check, deadline_s=25.0, begin=lambda node: robot.have_running(node, *LAUNCH))


# --- the battery


@on_battery(points=0.5, proves=["nodes", "topic_battery", "topic_distance", "topic_docked", "capacity_m", "publish_hz",
                                 "low_fraction", "start"])  # fmt: skip
def battery_up(node: GradedNode) -> None:
    """battery.py alone: the node battery, its topics and its parameters."""
    robot.require_graph(node, {"/battery": {"capacity_m": 100.0, "publish_hz": 5.0, "low_fraction": 0.2}})


@on_battery(points=1.0, after=["battery_up"], proves=["rate"])
def battery_rate(node: GradedNode) -> Evidence:
    """battery.py alone: it publishes at publish_hz, even after a change."""
    hertz = node.context.random.uniform(15.0, 25.0)
    node.set({"publish_hz": hertz}, of="/battery").accepted()
    seen = expect_rate(node, STATE, 1.0 / hertz, (0.75 / hertz, 1.25 / hertz))
    node.set({"publish_hz": 50.0}, of="/battery")  # for the checks below, which who refuses loses no points for
    return seen


@on_battery(points=2.5, after=["battery_up"], proves=["full", "falls", "first_distance", "restart", "capacity_change"])
def battery_falls(node: GradedNode) -> None:
    """battery.py alone: its charge is full at the start, and falls with the distance driven."""
    full = Approximation(1.0, absolute=CLOSE)
    robot.expect_soon(node, STATE, "A battery that was just started is full.", percentage=full)  # not charged yet
    node.send(DOCKED, data=True)
    node.wait(CALM_S)
    robot.expect_soon(node, STATE, "It is never more than full.", percentage=full)
    node.send(DOCKED, data=False)
    robot.expect_soon(node, STATE, "The robot has left the dock.", power_supply_status=robot.DISCHARGING)
    metres, more = node.context.random.uniform(2.0, 4.0), node.context.random.uniform(2.0, 4.0)
    robot.drive_so_far(node, 7.0, 0.0, "The first message only says where the counting begins.")
    why = "The charge falls by the metres driven since the previous message, divided by capacity_m."
    robot.drive_so_far(node, 7.0 + metres, metres / 100.0, why)
    robot.drive_so_far(node, 7.0 + metres + more, more / 100.0, why)
    node.set({"capacity_m": 50.0}, of="/battery").accepted()
    robot.drive_so_far(node, 12.0 + metres + more, 0.1, "capacity_m was 50.0 when these 5 m were driven.")
    why = "A smaller number comes from a carrier that was started again: nothing was driven, and counting begins there."
    robot.drive_so_far(node, 0.5, 0.0, why)
    robot.drive_so_far(node, 5.5, 0.1, why)
    robot.drive_so_far(node, 500.0, 1.0, "It is never below 0.0.")


@on_battery(points=1.0, after=["battery_up"], proves=["charges", "status", "health", "within_1_s"])
def battery_charges(node: GradedNode) -> None:
    """battery.py alone: the battery counts as low below low_fraction, and charges at the dock."""
    for metres in (600.0, 690.0):  # whatever it makes of that, it is not full then
        node.send(DISTANCE, data=metres)
    for low, health in ((0.0, robot.GOOD), (0.95, robot.LOW), (0.0, robot.GOOD)):
        if node.set({"low_fraction": low}, of="/battery").result.successful:
            robot.expect_soon(node, STATE, f"low_fraction is {low}.", power_supply_health=health)
    inbox = node.inbox(STATE)
    for turn, seconds in enumerate((0.5, 0.5, 1.0, 2.0)):  # a busy machine is now and then late
        metres = 690.0 + 90.0 * turn  # before each turn it has fallen: a full battery would charge slowly
        node.send(DISTANCE, data=metres)
        node.send(DOCKED, data=True)
        robot.expect_soon(node, STATE, "The robot stands at the dock.", power_supply_status=robot.CHARGING)
        node.send(DISTANCE, data=metres + 0.01)
        node.get("capacity_m", of="/battery")  # answered after that: whatever falls by it has fallen
        node.wait(CALM_S)
        first, began = inbox.messages[-1].percentage, inbox.times[-1]
        node.context.wait_until(lambda end=began + seconds: inbox.times[-1] >= end, PATIENCE_S)  # type: ignore[misc]
        rate = (inbox.messages[-1].percentage - first) / max(inbox.times[-1] - began, CLOSE)
        robot.expect_soon(node, STATE, f"{DOCKED} is still true.", power_supply_status=robot.CHARGING)
        node.send(DOCKED, data=False)
        robot.expect_soon(node, STATE, "The robot has left the dock.", power_supply_status=robot.DISCHARGING)
        left = inbox.messages[-1].percentage
        node.wait(CALM_S)
        robot.expect_soon(node, STATE, "It rises only at the dock.", percentage=Approximation(left, absolute=CLOSE))
        evidence = Evidence(f"{DOCKED}: true", "percentage rises by 0.05 to 0.2 a second", f"by {rate:.3f}")
        if right := 0.05 <= rate <= 0.2:  # noqa: PLR2004 - as the text says
            break
    robot.require(right, evidence, "At the dock the battery charges by about 0.1 a second.")


@on_battery(points=1.5, after=["battery_up"], proves=["refused", "reason", "capacity_m", "publish_hz", "low_fraction"])
def battery_refuses(node: GradedNode) -> None:
    """battery.py alone: invalid parameter values are refused, valid ones are not."""
    node.set({"capacity_m": 1000.0}, of="/battery").accepted()
    node.send(DISTANCE, data=0.0)
    for name, values in INVALID.items():
        for value in values:
            change = node.set({name: value}, of="/battery")
            change.refused()
            if name not in change.result.reason:
                why = f"The reason does not name {name}."
                change.fail(why, expected=f"a reason with {name}", diagnosis="validation.no_reason")
    if "charge" in node.context.memory:  # else it does not fall as it has to
        left = node.inbox(STATE).messages[-1].percentage - 0.01
        node.send(DISTANCE, data=10.0)
        why = "capacity_m is still 1000.0, as every change after that was refused."
        robot.expect_soon(node, STATE, why, percentage=Approximation(left, absolute=CLOSE))
    for name, value in VALID:
        node.set({name: value}, of="/battery").accepted()


# --- the door


@on_door(points=0.5, proves=["nodes", "service_door", "locked", "opening_s", "scripts", "start"])
def door_up(node: GradedNode) -> None:
    """door.py alone: the node door, its service and its parameters."""
    robot.require_graph(node, {"/door": {"locked": False, "opening_s": 0.5}})


@on_door(points=1.5, after=["door_up"], proves=["opens", "closes"])
def door_opens(node: GradedNode) -> None:
    """door.py alone: it opens after opening_s, and closes at once."""
    for seconds in (0.55, 0.05):
        node.set({"opening_s": seconds}, of="/door").accepted()
        node.context.record.add_sent(f"request {OPEN}: data=True, which {seconds / 2} s later is sent again")
        node.context.grader_node.client(SetBool, OPEN, 1).send(SetBool.Request(data=True))
        node.wait(seconds / 2)
        answer = node.call(OPEN, data=True).expect(success=True)
        answer.not_before(seconds)
        answer.within(seconds + SHOWN_S)
    node.set({"opening_s": 2.0}, of="/door").accepted()
    node.call(OPEN, data=False).expect(success=True).within(SHOWN_S)


@on_door(points=1.5, after=["door_up"], proves=["refuses", "says_why", "unlocked", "closes"])
def door_locked(node: GradedNode) -> None:
    """door.py alone: while it is locked it refuses to open, and says why."""
    node.set({"opening_s": 2.0, "locked": True}, of="/door").accepted()
    answer = node.call(OPEN, data=True)
    answer.refused(what="a request to open, although the door is locked")
    answer.within(SHOWN_S)
    node.call(OPEN, data=False).expect(success=True)
    node.set({"opening_s": 0.05, "locked": False}, of="/door").accepted()
    node.call(OPEN, data=True).expect(success=True, why="The door is no longer locked.")


@on_door(points=1.5, after=["door_opens", "door_locked"], proves=["free", "judged_once"])
def door_free(node: GradedNode) -> None:
    """door.py alone: while it opens, it answers all other requests."""
    context, client = node.context, node.context.grader_node.client(SetBool, OPEN, 1)
    context.wait_until(client.is_ready, PATIENCE_S)
    for opening_s, head_start_s in ((0.4, 0.1), (3.0, 1.0)):  # the second where a busy machine has spoiled the first
        node.set({"opening_s": opening_s, "locked": False}, of="/door").accepted()
        opened = client.send(SetBool.Request(data=True))
        context.wait_until(opened.is_answered, head_start_s)
        node.call(OPEN, data=False).expect(success=True)
        node.set({"locked": True}, of="/door").accepted()
        node.call(OPEN, data=True).refused()
        in_time = not opened.is_answered()
        context.wait_until(opened.is_answered, opening_s + PATIENCE_S)
        node.set({"locked": False}, of="/door").accepted()
        if right := in_time and opened.is_answered() and opened.response().success:
            break
    sent = "a request to open; meanwhile requests to close and to open, and a change of locked"
    evidence = Evidence(sent, "all others answered while the door opens", "the door was open before they were answered")
    robot.require(in_time, evidence, "While your node opens the door, it answers nobody else.", "service.blocks")
    evidence = Evidence("a request to open; then one to close, and locked=True", "the door opens", "it did not")
    robot.require(right, evidence, "A request that came before the door was locked still opens it.")


# --- the carrier


@on_carrier(points=0.5, proves=["nodes", "action_deliver", "topic_battery", "topic_distance", "topic_docked",
                                 "room_names", "room_distances_m", "speed_mps", "door_timeout_s",
                                 "scripts"])  # fmt: skip
def carrier_up(node: GradedNode) -> None:
    """carrier.py alone: the node carrier, its action, its topics and its parameters."""
    why = "The grader gave it the expected values at the start, with -p."
    given = {**robot.BUILDING, "door_timeout_s": PATIENCE_S}
    robot.require_graph(node, {"/carrier": given}, why, "parameter.override_ignored")


@on_carrier(points=3.0, after=["carrier_up"], proves=["rooms", "asks", "drives", "delivered", "next_goal", "odometry"])
def carrier_delivers(node: GradedNode) -> None:
    """carrier.py alone: it asks the door, drives, and reports the distance."""
    for room in ("attic", "cellar"):
        goal = robot.ask_for_delivery(node, room)
        node.wait(CALM_S)
        robot.expect_distance(node)
        evidence = Evidence(goal.shown, "the goal waits until the door has answered", "it has ended")
        robot.require(goal.over_at is None, evidence, "The carrier has to wait for the door's answer.")
        robot.deliver(node, room, goal=goal)


@on_carrier(points=1.0, after=["carrier_delivers"], proves=["tells_phase", "tells_remaining", "tells_battery"])
def carrier_feedback(node: GradedNode) -> None:
    """carrier.py alone: feedback has the phase, the remaining distance, and the battery."""
    goal = robot.ask_for_delivery(node, "hall")
    node.wait(CALM_S)
    early, metres = [seen.feedback for seen in goal.feedback], node.context.memory["at"] - robot.ROOMS["hall"]
    node.send(STATE, percentage=robot.LESS, power_supply_health=robot.GOOD)
    node.wait(CALM_S)
    robot.deliver(node, "hall", goal=goal)
    messages = goal.wait_for_last_feedback(
        lambda many: any(seen.feedback.distance_remaining < robot.END_M for seen in many)
    )
    heard = [seen.feedback for seen in messages]
    driving = [seen.came_s for seen in messages if seen.feedback.phase == robot.DRIVING]
    left, took_s = [seen.distance_remaining for seen in heard], driving[-1] - driving[0] if driving else 0.0
    often = len(driving) >= max(5 * metres / robot.ALONE_MPS, 1 + 3 * took_s)  # a busy machine is now and then late
    got = f"{len(heard)} messages, {len(driving)} of them on the way: {'; '.join(map(in_one_line, heard[:3]))}"
    asks = early and all(seen.phase == robot.DOOR for seen in early)
    for right, expected in (
        (asks, f"phase={robot.DOOR} as long as the door has not answered"),
        (often, f"phase={robot.DRIVING} five times a second on the way"),
        (left and abs(left[0] - metres) < robot.END_M >= left[-1], "distance_remaining from the whole distance to 0"),
        (left == sorted(left, reverse=True), "distance_remaining that never grows"),
        (all(abs(seen.battery - robot.CHARGE) < CLOSE for seen in early), f"battery={robot.CHARGE}, as {STATE} said"),
        (heard and abs(heard[-1].battery - robot.LESS) < CLOSE, f"battery={robot.LESS} at the end, as {STATE} said"),
    ):
        robot.require(right, Evidence(goal.shown, expected, got), f"The feedback does not show {expected}.")


@on_carrier(points=1.0, after=["carrier_delivers"], proves=["unknown_room", "low_battery", "rooms"])
def carrier_rejects(node: GradedNode) -> None:
    """carrier.py alone: it rejects unknown rooms and, while the battery is low, every room except the dock."""
    for room in (f"room {node.context.random.randrange(100, 1000)}", "Attic", ""):
        node.goal(DELIVER, room=room).rejected(what=f"the room {room!r}, which is not in room_names")
    node.send(STATE, percentage=robot.CHARGE, power_supply_health=robot.LOW)
    node.wait(CALM_S)
    robot.send_until(node, "attic", "rejected").rejected(what="a delivery, although the battery is low")
    robot.deliver(node, "dock")
    node.send(STATE, percentage=robot.CHARGE, power_supply_health=robot.GOOD)
    robot.send_until(node, "hall", "delivered").accepted_by().ends()


@on_carrier(points=1.5, after=["carrier_delivers"], proves=["second_goal", "undisturbed"])
def carrier_one_goal(node: GradedNode) -> None:
    """carrier.py alone: one goal at a time; if two goals come at the same instant, only one is accepted."""
    goal = robot.ask_for_delivery(node, "attic")
    node.goal(DELIVER, room="nowhere").wait_for_answer("the goal rejected")  # and that changes nothing
    robot.require_one(node, goal, node.goal(DELIVER, room="cellar"))
    robot.open_door(node)
    robot.wait_until_driving(node, goal)
    last = robot.require_one(node, goal, node.goal(DELIVER, room="hall"))
    robot.finish(node, goal, "attic", PATIENCE_S)
    goal.ends(delivered=True)
    if last is not goal:  # it came when the first was over
        robot.finish(node, last, "hall", PATIENCE_S)
    for room in ("cellar", "attic", "cellar", "attic"):  # which callback comes first is a matter of chance
        offer_service(node, OPEN, SetBool)
        goal = robot.require_one(node, node.goal(DELIVER, room=room), node.goal(DELIVER, room=room))
        robot.deliver(node, room, goal=goal)


@on_carrier(points=1.0, after=["carrier_delivers"], proves=["door_refuses", "door_says_why", "after_abort", "asks"])
def carrier_refused(node: GradedNode) -> None:
    """carrier.py alone: a door that refuses ends the delivery, with the reason."""
    words = f"the key of hall {node.context.random.randrange(100, 1000)} is missing"
    offer_service(node, OPEN, SetBool, success=False, message=words)
    robot.require_aborted(node.goal(DELIVER, room="cellar").accepted_by(), SHOWN_S, words)
    robot.deliver(node, "cellar")
    robot.deliver(node, "cellar", goal=robot.ask_for_delivery(node, "cellar"))  # where it stands already


@on_carrier(points=1.0, after=["carrier_delivers"], proves=["cancel", "stops", "settings", "drives", "odometry"])
def carrier_cancel(node: GradedNode) -> None:
    """carrier.py alone: a delivery can be cancelled at the door and on the way, and the next one works."""
    memory, goal = node.context.memory, robot.ask_for_delivery(node, "tower")
    node.wait(CALM_S)
    robot.require_stop(node, goal, 0.0)
    robot.open_door(node)
    goal = node.goal(DELIVER, room="tower").accepted_by()
    robot.wait_until_driving(node, goal, messages=5)
    node.set({"speed_mps": robot.FAST_MPS}, of="/carrier").accepted()
    node.wait(CALM_S)
    memory["at"] += robot.require_stop(node, goal, robot.ALONE_MPS)
    node.set({"speed_mps": robot.CREEP_MPS}, of="/carrier").accepted()
    goal = node.goal(DELIVER, room="gate").accepted_by()
    robot.wait_until_driving(node, goal)
    memory["at"] -= robot.require_stop(node, goal, robot.CREEP_MPS)
    robot.expect_distance(node)
    why = "The robot stands where it was stopped, on the way to the gate, which is where the dock is."
    robot.expect_soon(node, DOCKED, why, data=False)
    rooms = {"room_names": ["shed"], "room_distances_m": [robot.PLACES["shed"]]}
    node.set({**rooms, "speed_mps": robot.SLOW_MPS}, of="/carrier").accepted()
    robot.deliver(node, "shed", robot.SLOW_MPS)
    node.set(robot.BUILDING, of="/carrier").accepted()


@on_carrier(points=1.0, after=["carrier_delivers"], proves=["door_silent", "after_abort", "asks"])
def carrier_silent(node: GradedNode) -> None:
    """carrier.py alone: if the door does not answer, the delivery is given up in time."""
    node.set({"door_timeout_s": 1.0}, of="/carrier").accepted()  # half of it is not as long on a busy machine, either
    robot.require_aborted(robot.ask_for_delivery(node, "hall"), 1.0 + robot.GIVES_UP_S, after_s=0.95)
    node.set({"door_timeout_s": PATIENCE_S}, of="/carrier").accepted()
    goal = robot.ask_for_delivery(node, "attic")
    offer_service(node, OPEN, SetBool).reply(SetBool.Response(success=False, message="too late"), 1)
    node.wait(CALM_S)
    robot.open_door(node)
    ended = robot.finish(node, goal, "attic", PATIENCE_S)
    why = "This answer of the door belongs to the delivery before, which was given up. It is no answer to the new one."
    robot.require("too late" not in ended.result.message, Evidence(goal.shown, "SUCCEEDED", ended.result.message), why)
    robot.send_until(node, "attic", "delivered", PATIENCE_S).accepted_by().ends()


# --- all together


@on_robot(points=1.5, proves=["launch", "argument", "yaml_battery", "yaml_door", "yaml_carrier", "nodes"])
def delivery_graph(node: GradedNode) -> Evidence:
    """delivery.launch.py: three nodes, all connections, the values of robot.yaml, and the speed."""
    why = "Your robot.yaml or your launch file has a different value, or the value does not reach the node."
    robot.require_graph(node, LAUNCHED, why, code=None)
    return Evidence(LAUNCH[0], "three nodes, connected", "three nodes, connected", node.context.see_graph())


@on_robot(points=2.0, after=["delivery_graph"], proves=["together", "odometry"])
def delivery_whole(node: GradedNode) -> None:
    """All together: a delivery works, and the battery falls."""
    why = "The battery does not hear that the robot stands at the dock."
    robot.expect_soon(node, STATE, why, power_supply_status=robot.CHARGING)
    node.set({"capacity_m": 2.0}, of="/battery").accepted()
    node.set({"opening_s": 0.05}, of="/door").accepted()
    node.context.wait_until(lambda: node.inbox(STATE).messages[-1].percentage > 1.0 - CLOSE, 8.0)  # at the dock
    robot.expect_soon(node, STATE, "It is never more than full.", percentage=Approximation(1.0, absolute=CLOSE))
    for room in ("kitchen", "office"):
        robot.send_until(node, room, "delivered", PATIENCE_S).accepted_by().ends()
    why = "The office lies 0.8 m from the dock, and the kitchen on the way: more was not to be driven."
    robot.expect_soon(node, DISTANCE, why, data=Approximation(0.8, absolute=2.0 * robot.NEAR_M))
    why = "The battery has to fall by the 0.8 m that the carrier has driven, divided by capacity_m, which is 2.0."
    fallen = Approximation(0.65, absolute=0.1)  # until it hears that the robot has left the dock it charges
    robot.expect_soon(node, STATE, why, power_supply_status=robot.DISCHARGING, percentage=fallen)
    node.set({"capacity_m": 20.0}, of="/battery").accepted()  # else some drives later it is low


@on_robot(points=1.5, after=["delivery_whole"], proves=["follow", "health", "within_1_s"])
def delivery_follows(node: GradedNode) -> None:
    """All together: when one node changes, the others follow."""
    node.set({"locked": True}, of="/door").accepted()
    words = node.call(OPEN, data=True).response.message
    robot.require_aborted(node.goal(DELIVER, room="lab").accepted_by(), PATIENCE_S, words)
    node.set({"locked": False}, of="/door").accepted()
    node.set({"low_fraction": 1.0}, of="/battery").accepted()
    robot.expect_soon(node, STATE, "It is below low_fraction now.", power_supply_health=robot.LOW)
    node.wait(CALM_S)
    robot.send_until(node, "lab", "rejected").rejected(what="a delivery, although the battery is low")
    node.set({"low_fraction": 0.2}, of="/battery").accepted()


@on_robot(points=1.0, after=["delivery_whole"], proves=["cancel_together"])
def delivery_cancel(node: GradedNode) -> None:
    """All together: a delivery can be cancelled while the door opens."""
    node.set({"door_timeout_s": 10.0}, of="/carrier").accepted()  # what is given up is not cancelled
    robot.deliver_at_door(node).cancelled().ends("CANCELED", within_s=SHOWN_S, delivered=False)
    node.set({"opening_s": 0.1}, of="/door").accepted()
    robot.send_until(node, "lab", "delivered", PATIENCE_S).accepted_by().ends()


@on_robot(points=1.5, after=["delivery_whole"], proves=["killed"])
def delivery_killed(node: GradedNode) -> None:
    """All together: if the door dies while it opens, the delivery is given up, and the carrier keeps running."""
    node.set({"door_timeout_s": 0.3}, of="/carrier").accepted()
    goal = robot.deliver_at_door(node)
    node.kill("door.py")  # a door in one process with the others lives on, and is silent for as long
    robot.require_aborted(goal, 0.3 + robot.GIVES_UP_S)
    node.get("door_timeout_s", of="/carrier")


@on_robot(points=1.0, after=["delivery_killed"], proves=["back"])
def delivery_back(node: GradedNode) -> None:
    """All together: when the door is back, the next delivery works."""
    robot.open_door(node)
    robot.send_until(node, "lab", "delivered", 5.0).accepted_by().ends()


CHECKS = [
    battery_up, battery_rate, battery_falls, battery_charges, battery_refuses,
    door_up, door_opens, door_locked, door_free,
    carrier_up, carrier_delivers, carrier_feedback, carrier_rejects,
    carrier_one_goal, carrier_refused, carrier_cancel, carrier_silent,
    delivery_graph, delivery_whole, delivery_follows, delivery_cancel, delivery_killed, delivery_back,
]  # fmt: skip

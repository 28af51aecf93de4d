"""Exercise 3: the node /velocity_limiter, in a conversation with a model; and its starts."""

from __future__ import annotations

import itertools
import math
import re
import time
from contextlib import suppress
from dataclasses import replace
from typing import Any

from course_kit.graders import _limiter
from course_kit.graders._limiter import BEYOND, CHANGES, DEFAULTS, NODE, STATUS, TYPES, LimiterSettings, LimiterSteps
from course_kit.grading.checks.answers import describe_value
from course_kit.grading.checks.parameters import start_arguments
from course_kit.grading.checks.ready_made import expect_rate, make_check
from course_kit.grading.checks.vocabulary import (
    CheckPart,
    Evidence,
    Failed,
    GradedNode,
    check,
    conversation,
    draw_between,
    draw_by,
    draw_one_of,
    endpoints_offered,
    step_rule,
)

_TOLD_S = 1.0  # what a program has printed arrives within milliseconds
_RATE = (0.42, 0.6)  # seconds between two lines, on average
_LINES, _LONGEST_GAP_S = 4, 0.9  # a line that comes with each change makes up for no slow timer
_SAID_BY_RCLPY = re.compile(r"^.*\]: Failed to (?:describe|get|set) parameter.*$", re.MULTILINE)
_WARNINGS = ("[WARN]", "[ERROR]", "[FATAL]")
_NAN, _INF = math.nan, math.inf
_LONG = {"robot_name": "  my robot: 2 of {the} %s laboratory, by the wall ", "max_velocity": 4.87654321}
_WRONG = {
    "max_velocity": (-1.0, 0.0, 5.0001, 7.5, _NAN, _INF, -_INF),
    "wheel_diameter": (0.0, -0.1, 0.0099, 1.0001, 20.0, _NAN, _INF, -_INF),
    "robot_name": ("",),
}
_EACH = ({"max_velocity": 8.0}, {"wheel_diameter": 2.0}, {"robot_name": ""})
_INVALID = tuple({name: value} for name, values in _WRONG.items() for value in values)
_TOGETHER = (  # by what is wrong
    ({"wheel_diameter": 0.5, "max_velocity": 6.0}, {"wheel_diameter": 0.5, "max_velocity": 0.0},
     {"enabled": False, "max_velocity": -1.0}, {"enabled": False, "max_velocity": 0.0},
     {"enabled": False, "wheel_diameter": 0.3, "max_velocity": 8.0}, {"max_velocity": 8.0, "enabled": False}),
    ({"max_velocity": 2.5, "wheel_diameter": 2.0}, {"wheel_diameter": _NAN, "max_velocity": 0.7}),
    ({"max_velocity": 1.5, "robot_name": ""}, {"enabled": False, "robot_name": ""},
     {"robot_name": "", "wheel_diameter": 0.4}),
)  # fmt: skip
_WITH_NAMES = ({"robot_name": "half", "max_velocity": 0.0}, {"robot_name": "half_2", "wheel_diameter": 0.0},
               {"enabled": False, "robot_name": "half_3", "wheel_diameter": 0.3, "max_velocity": 8.0})  # fmt: skip
_OTHER_TYPES = ({"max_velocity": "fast"}, {"max_velocity": 2}, {"enabled": 1}, {"enabled": "yes"},
                {"robot_name": 7}, {"wheel_diameter": 1})  # fmt: skip
_SHARES = (0.5, 1.0, -1.0, 1.01, -1.01)  # of the limit: the limit itself passes, and nothing beyond
_SMALL = [0.004, *[0.0] * 5]  # no dead zone
_BACKWARDS = [-BEYOND, 0.4, 0.3, 0.2, 0.1, -0.1]
_COMMANDS = ([0.0] * 6, _SMALL, [_INF, *[0.0] * 5], [-8.0, _NAN, -_INF, 0.5, 1e-12, _NAN])
_ANY = draw_by(lambda rng: [rng.uniform(-BEYOND, BEYOND), *(rng.uniform(-3.0, 3.0) for _ in _limiter.NAMES[1:])])


class Limiter(LimiterSteps):
    """A velocity limiter, and what may be asked of it, in any order."""

    refuse = step_rule("reason", values=draw_one_of(*_EACH))(LimiterSteps.refuse)

    def end(self, node: GradedNode) -> None:
        """After all of it the node does what it did; and nothing comes late."""
        given = {**_LONG, "wheel_diameter": 0.3, "enabled": True}
        if self.lost & {"atomic", *CHANGES.values()}:
            kept = [name for name in given if CHANGES[name] not in self.lost]
            for values in ({**given, "enabled": False}, given):
                for name in (*kept, *kept):  # each also before the others
                    self.accept(node, {name: values[name]}, CHANGES[name])
                self.drive(node, [BEYOND, *[0.1] * 5])
        else:
            self.accept(node, {"enabled": False}, "change_enabled")
            self.set_several(node, given)
            self.drive(node, [BEYOND, *[0.1] * 5])
        self.refuse_each(node)
        self.lines = node.inbox(STATUS).count
        if "change_status" not in self.lost:
            self.accept(node, {"robot_name": "the name alone"}, "change_status")
            self.lines = node.inbox(STATUS).count
        self.require_quiet(node, self.sent_at + _limiter.LATE_S - time.monotonic(), enabled=True)
        if "reacts" not in self.lost:
            self.drive(node, _SMALL)  # after a while without commands
        if "change_velocity" in self.lost and node.set(max_velocity=0.7, of=NODE).result.successful:
            self.keep_values({"max_velocity": 0.7})  # /status tells it, whatever commands show
            self.lines = node.inbox(STATUS).count
        self.require_status(node)
        self.heard_at = list(node.inbox(STATUS).times)
        if node.context.job.mode == "attach":
            node.set(vars(self.start), of=NODE)

    @step_rule("reacts", fields=draw_one_of(*_COMMANDS, _ANY))
    def look_at_command(self, node: GradedNode, fields: list[float]) -> None:
        """A command, when all changes act; and the parameters have their values."""
        self.require_values(node)
        self.have_enabled(node)
        self.drive(node, fields)

    @step_rule("change_velocity", case=draw_one_of((0.01, 5.0), (1.0, 0.001)))
    def set_both(self, node: GradedNode, case: tuple[float, float]) -> None:
        """Both numbers act."""
        self.have_enabled(node)
        for name, value in zip(("wheel_diameter", "max_velocity"), case, strict=True):
            for _ in range(2 if CHANGES[name] not in self.lost else 0):  # the value that it has already is valid, too
                self.accept(node, {name: value}, CHANGES[name])
        self.drive(node, _BACKWARDS)
        if "limits" in self.lost:
            self.require_effect(node, "max_velocity", 1.0, 3.0)

    @step_rule("change_diameter", value=draw_between(0.011, 0.9))
    def set_diameter(self, node: GradedNode, value: float) -> None:
        """So does the diameter alone."""
        self.have_enabled(node)
        self.accept(node, {"wheel_diameter": value}, "change_diameter")
        self.drive(node, _BACKWARDS)
        if "wheel_speed" in self.lost:
            self.require_effect(node, "wheel_diameter", 0.2, 0.6)

    @step_rule("change_enabled")
    def switch_off(self, node: GradedNode) -> None:
        """Off acts, on a command to stand or to turn on the spot, too."""
        for _ in range(2):  # the value that it has already is valid, too
            self.accept(node, {"enabled": False}, "change_enabled")
        self.refuse_each(node)
        for fields in ([0.5 * self.settings.max_velocity, 0.2, 0.4, 0.6, 0.8, 1.0], [0.0] * 5 + [0.5], [0.0] * 6):
            self.drive(node, fields)
        self.require_status(node)

    @step_rule("change_enabled", velocity=draw_between(1.1, 4.0), diameter=draw_between(0.02, 0.9))
    def switch_on(self, node: GradedNode, velocity: float, diameter: float) -> None:
        """On acts, and so does what was changed meanwhile."""
        if self.settings.enabled:
            self.accept(node, {"enabled": False}, "change_enabled")
        for name, value in (("max_velocity", velocity), ("wheel_diameter", diameter)):
            if CHANGES[name] not in self.lost:
                self.accept(node, {name: value}, CHANGES[name])
        for _ in range(2):
            self.accept(node, {"enabled": True}, "change_enabled")
        self.refuse_each(node)
        for share in _SHARES:
            self.drive(node, [share * self.settings.max_velocity, 0.2, 0.4, 0.6, 0.8, 1.0])

    @step_rule("change_status", value=draw_one_of(" ", "Zo\u00eb \u83ef"))
    def set_name(self, node: GradedNode, value: str) -> None:
        """A name, in any language, shows, and those that are refused do not."""
        self.accept(node, {"robot_name": value}, "change_status")
        for values in _WITH_NAMES if not self.lost & {"atomic", "refuses", "reason"} else ():
            self.refuse(node, values)
        if value != " ":
            self.lines = node.inbox(STATUS).count

    @step_rule(
        "change_status",
        values=draw_one_of(
            {"wheel_diameter": draw_between(0.02, 0.9), "robot_name": "both", "enabled": True},
            {"enabled": True, "max_velocity": draw_between(0.2, 4.0), "robot_name": "all", "wheel_diameter": 0.25},
        ),
    )
    def set_several(self, node: GradedNode, values: dict[str, Any]) -> None:
        """Several valid values at once."""
        self.accept(node, values, "atomic")

    @step_rule("refuses", often=2 * len(_INVALID), values=draw_one_of(*_INVALID))
    def refuse_invalid(self, node: GradedNode, values: dict[str, Any]) -> None:
        """An invalid value."""
        self.refuse(node, values)

    def have_enabled(self, node: GradedNode) -> None:
        """What a command brings is seen with the robot on alone."""
        if not self.settings.enabled and "change_enabled" not in self.lost:
            self.accept(node, {"enabled": True}, "change_enabled")

    def refuse_each(self, node: GradedNode) -> None:
        """What is refused neither stops the robot nor lets it drive again, as is seen afterwards."""
        for values in _EACH if not self.lost & {"refuses", "reason"} else ():
            self.refuse(node, values)

    @step_rule("atomic", sets=draw_one_of(*_TOGETHER))
    def refuse_together(self, node: GradedNode, sets: tuple[dict[str, Any], ...]) -> None:
        """Valid and invalid values at once; what is refused does not act."""
        self.have_enabled(node)
        for values in sets:
            self.refuse(node, values)
        for speed in (BEYOND, BEYOND, 0.01, 0.01):  # the same command twice running
            self.drive(node, [speed, -0.1, -0.2, -0.3, -0.4, -0.5])

    @step_rule("wrong_type", values=draw_one_of(*_OTHER_TYPES))
    def set_other_type(self, node: GradedNode, values: dict[str, Any]) -> None:
        """A value of another type."""
        name = next(iter(values))
        node.set(values, of=NODE).refused(expected=f"refused: {name} is a {TYPES[name]}", diagnosis="parameter.type")
        self.past.append((values, True))

    @step_rule("undeclared", values=draw_one_of({"wheel_count": 4}, {"max_velocity_": 1.0}))
    def set_undeclared(self, node: GradedNode, values: dict[str, Any]) -> None:
        """A parameter that is not declared."""
        node.set(values, of=NODE).refused(expected="refused: it is not declared", diagnosis="parameter.undeclared")


@check(points=0.5, proves=["node", "only_a_class", "a_program", "start"])
def node_up(node: GradedNode) -> Evidence:
    """The node velocity_limiter starts, and answers requests for its parameters."""
    node.prepare()
    return node.parameters(NODE).expect_served()


@check(points=0.5, after=["types"], proves=list(TYPES))
def defaults(node: GradedNode) -> Evidence:
    """Each parameter has its default."""
    others = node.get(*TYPES, of=NODE) if node.context.job.mode == "attach" else {}  # somebody else has set it
    return node.parameters(NODE).expect_values({**vars(DEFAULTS), **others})


@check(points=0.5, after=["status"], proves=["status_rate"])
def status_rate(node: GradedNode) -> Evidence:
    """/status is published twice a second."""
    held = node.context.conversations[Limiter]
    heard = held.last.heard_at if held.last is not None else []
    gaps = [after - before for before, after in itertools.pairwise(heard)]
    if len(gaps) >= _LINES and max(gaps) <= _LONGEST_GAP_S and _RATE[0] <= sum(gaps) / len(gaps) <= _RATE[1]:
        return Evidence("", f"a line every {_RATE[0]:g} to {_RATE[1]:g} s, on average", f"{len(heard)} lines")
    node.ensure_running()  # afresh, after a change, with changes and commands that are no matter of the line
    with suppress(Failed):
        node.set({**_LONG, "max_velocity": 0.7}, of=NODE)
    diameters = itertools.cycle((0.2, 0.3))

    def disturb() -> None:
        with suppress(Failed):
            node.set({"wheel_diameter": next(diameters)}, of=NODE)
        if "reacts" not in held.lost_checks:
            node.send(_limiter.COMMAND)

    return expect_rate(node, STATUS, 0.5, _RATE, disturb)


def _start(node: GradedNode, given: dict[str, Any], sent: str, **start: Any) -> Evidence:
    """Start with these values; they act."""
    context = node.context
    try:
        node.start(**start)
        node.ensure_running()
    except Failed as failed:
        failed.evidence, process = replace(failed.evidence, sent=sent), context.program.status()
        last = [text.rstrip().rpartition("\n")[2] for text in (process.stderr, process.stdout)]
        if failed.diagnosis in ("start.crash", "start.exit") and any(name in text for name in TYPES for text in last):
            why = f"The grader started your program with valid values. {failed.message}"
            failed.message, failed.diagnosis = why, "validation.overzealous"
        raise
    started = node.get(*TYPES, of=NODE)
    model = Limiter(LimiterSettings(**{**started, **given}))
    model.lost = context.conversations[Limiter].lost_checks
    evidence = Evidence(sent, describe_value(given), describe_value({name: started[name] for name in given}))
    if evidence.got != evidence.expected:
        why = "The program was started with these values, but its parameters have others."
        raise Failed(evidence, why, "parameter.override_ignored")
    off = not model.settings.enabled
    if off and "change_enabled" in model.lost:
        return evidence
    try:
        model.lines = node.inbox(STATUS).count
        model.drive(node, [BEYOND, 0.1, 0.2, 0.3, 0.4, 0.5], sent)
        if off:
            model.accept(node, {"enabled": True}, "")
            model.drive(node, [-BEYOND, 0.0, 0.0, 0.0, 0.0, 0.0], sent)
        if "robot_name" in given:
            model.require_status(node, sent)
    except Failed as failed:
        if failed.diagnosis in (None, "math.formula", "parameter.read_once"):
            why = f"The parameter has the value given at the start, but the node acts on another. {failed.message}"
            failed.message, failed.diagnosis = why, "parameter.override_ignored"
        raise
    return evidence


@check(points=1.0, after=["reacts"], deadline_s=25.0, proves=["start_arguments", "init_sees_arguments"])
def start_arguments_count(node: GradedNode) -> Evidence:
    """Values given at the start with -p take effect."""
    highest = 4.9 if "change_velocity" in node.context.conversations[Limiter].lost_checks else 5.0
    given = {"max_velocity": highest, "wheel_diameter": round(node.context.random.uniform(0.2, 0.9), 1)}
    return _start(node, given, " ".join(start_arguments(given)), parameters=given)


@check(points=0.5, after=["reacts", "status"], deadline_s=25.0, proves=["start_file"])
def start_file(node: GradedNode) -> Evidence:
    """Values given at the start in a parameter file take effect."""
    rng = node.context.random
    name, velocity = f"rover {rng.randrange(100, 1000)}", round(rng.uniform(0.2, 0.9), 1)
    given = {"robot_name": name, "enabled": False, "max_velocity": velocity}
    sent = f"--params-file parameters.yaml, in which {describe_value(given)}"
    seen = _start(node, given, sent, file=given, of=NODE)
    node.context.spoil()
    return seen


@check(points=1.0, after=["start_arguments", "defaults"], deadline_s=25.0, proves=["start_invalid"])
def start_invalid(node: GradedNode) -> Evidence:
    """An invalid value given at the start is not used, and the node says so."""
    _require_not_used(node, {"max_velocity": 0.0}, wheel_diameter=0.5)  # which a range lets through
    _require_not_used(node, {"max_velocity": 7.5})
    _require_not_used(node, {"robot_name": ""})
    return _require_not_used(node, {"wheel_diameter": math.nan}, max_velocity=2.5)


def _require_not_used(node: GradedNode, values: dict[str, Any], **valid: Any) -> Evidence:
    """An invalid value stops the node with an error, or is replaced by the default with a warning."""
    context, (name,) = node.context, values
    sent = " ".join(start_arguments({**values, **valid}))
    evidence = Evidence(sent, f"an error that names {name} and the end of the program, or a warning and the default")
    try:
        try:
            node.start(parameters={**values, **valid})
            node.ensure_running()
        except Failed as failed:
            if context.program.status(fresh=True).running:
                failed.evidence = replace(failed.evidence, sent=sent)
                raise
            return _require_words(node, (name,), replace(evidence, got="the program ended"))
        try:
            model = Limiter(LimiterSettings(**valid))
            model.lost = context.conversations[Limiter].lost_checks | {"one_each"}
            model.lost |= {"wheel_speed"} if name != "wheel_diameter" else set()
            model.drive(node, [BEYOND, 0.0, 0.0, 0.0, 0.0, 0.0], sent)
            model.require_values(node, sent)
        except Failed as failed:
            why = f"Your node started with {describe_value(values)}, which it should have refused."
            if node.get(name, of=NODE)[name] == vars(DEFAULTS)[name]:
                why = f"{name} has its default, as it should, but: {failed.message}"
            raise Failed(replace(evidence, got=failed.evidence.got), why, "validation.missing") from None
        return _require_words(node, (name, *_WARNINGS), replace(evidence, got="it runs with the default"))
    finally:
        context.spoil()


def _require_words(node: GradedNode, words: tuple[str, ...], evidence: Evidence) -> Evidence:
    """Somebody reads the terminal: it has to say what happened. By itself this earns nothing."""

    def has_words() -> bool:
        process = node.context.program.status(fresh=True)
        own = _SAID_BY_RCLPY.sub("", process.stdout + process.stderr)
        return any(word in own for word in words)

    if not node.context.wait_until(has_words, _TOLD_S, of_the_living=False):
        evidence = replace(evidence, got=f"{evidence.got}, and its output does not name {words[0]}")
        why = f"The program's output does not name {words[0]}, so its user cannot tell what was wrong."
        raise Failed(evidence, why, "validation.no_reason")
    return evidence


CHECKS = [
    node_up,
    endpoints_offered(check_id="topics", points=0.5, after=["node_up"],
                      title="The four topics exist, and a publisher or subscription with default QoS connects to each",
                      proves=["topic_command", "topic_velocity", "topic_wheel", "topic_status", "qos"]),
    make_check(lambda node: node.parameters(NODE).expect_names(TYPES), check_id="declared", points=0.5,
               title="The four parameters are declared", after=["node_up"], proves=list(TYPES)),
    make_check(lambda node: node.parameters(NODE).expect_types(vars(DEFAULTS)), check_id="types", points=0.5,
               title="Each parameter has its type", after=["declared"], proves=list(TYPES)),
    defaults,
    *conversation(
        Limiter,
        CheckPart("reacts", "A command on /cmd_vel_in brings a message on /cmd_vel and on /wheel_speed",
                  points=0.5, proves=["within_3_s", "topic_command", "topic_velocity", "topic_wheel"]),
        CheckPart("limits", "linear.x is limited in both directions, and nothing else is changed",
                  points=1.5, proves=["limited", "sign_and_rest"], after=["reacts"]),
        CheckPart("wheel_speed", "/wheel_speed is the wheel's speed in rad/s for the published velocity",
                  points=1.0, proves=["wheels"], after=["reacts"]),
        CheckPart("one_each", "Each command brings exactly one message on each topic",
                  points=0.5, proves=["one_each"], after=["reacts"]),
        CheckPart("status", "/status shows name and velocity", points=1.0, proves=["status_line", "topic_status"]),
        CheckPart("change_velocity", "A change of max_velocity affects the next command",
                  points=1.0, proves=["next_message", "ends_valid", "max_velocity"], after=["reacts"]),
        CheckPart("change_diameter", "A change of wheel_diameter affects the next command",
                  points=1.0, proves=["next_message", "ends_valid", "wheel_diameter"], after=["reacts"]),
        CheckPart("change_enabled", "With enabled=False the robot stands still, with enabled=True it drives again",
                  points=1.0, proves=["next_message", "disabled", "one_each_disabled"], after=["reacts"]),
        CheckPart("change_status", "A change of robot_name and max_velocity shows in the next /status",
                  points=0.5, proves=["next_message", "change_answered", "unrounded", "status_line", "robot_name"],
                  after=["status"]),
        CheckPart("refuses", "An invalid value is refused, and the old one stays",
                  points=2.5, proves=["refused", "ends_refused"]),
        CheckPart("reason", "A refusal names the parameter and its range", points=1.5, proves=["reason"]),
        CheckPart("wrong_type", "A value of another type is refused", points=0.5, proves=["other_type"]),
        CheckPart("undeclared", "An undeclared parameter is refused", points=0.5, proves=["undeclared"]),
        CheckPart("atomic", "When a valid and an invalid value are set atomically, nothing changes",
                  points=1.5, proves=["atomic"]),
        steps=1, after=["types", "topics"], deadline_s=90.0,
    ),
    status_rate,
    replace(start_arguments_count, id="start_arguments"),
    start_file,
    start_invalid,
]  # fmt: skip

"""Exercise 3: what a velocity limiter has to do, given its parameters, and the steps by which that is asked of a node.

What a parameter does is judged by what comes out on the topics, 0.2 s after a change was confirmed.
"""

from __future__ import annotations

import itertools
import math
import re
import time
from contextlib import suppress
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from geometry_msgs.msg import Twist, Vector3

from course_kit.grading.checks.answers import Change, are_same, describe_value
from course_kit.grading.checks.graded_node import MESSAGE_S
from course_kit.grading.checks.vocabulary import Evidence, Failed, GradedNode, Model

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    Done = dict[str, Any] | list[float]  # values that were set, or the fields of a command

# Of an end, as a share: rclpy's own text has the smallest number above 0 for a range that excludes 0, and who has the
# end itself wrong loses no points here.
_NEAR = 0.15
_PLAIN = [0.4, 0.0, 0.0, 0.0, 0.0, 0.2]  # the first command, below each limit
BEYOND = 9.0  # m/s, above every valid limit
_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
NODE, COMMAND, LIMITED, WHEEL, STATUS = "/velocity_limiter", "/cmd_vel_in", "/cmd_vel", "/wheel_speed", "/status"
_ACTS_S = 0.2  # after a change was confirmed it acts on every command that is sent
ANSWER_S, _LINE_S, SILENT_S = 1.0, 1.0, 2.0  # of a change; in which it shows on /status; four periods of that
_ONCE = "Publish once for each command, in the callback that receives the command, and at no other time."
_NO_EFFECT = "Your node accepted the change, but the output is the same as before."
_SOON_S, _AT_ONCE_S, LATE_S = 0.15, 0.06, 1.05  # how long what nobody asked for is waited for; the last at the end
NAMES = [f"{part}.{axis}" for part in ("linear", "angular") for axis in "xyz"]
_fields_of = attrgetter(*NAMES)
TYPES = {"robot_name": "string", "max_velocity": "double", "wheel_diameter": "double", "enabled": "bool"}
BOUNDS = {"max_velocity": (0.0, 5.0), "wheel_diameter": (0.01, 1.0)}
RANGES = {"robot_name": "not empty", "max_velocity": "0.0 < max_velocity <= 5.0",
          "wheel_diameter": "0.01 <= wheel_diameter <= 1.0"}  # fmt: skip
CHANGES = {"max_velocity": "change_velocity", "wheel_diameter": "change_diameter", "enabled": "change_enabled",
           "robot_name": "change_status"}  # fmt: skip


@dataclass(frozen=True)
class LimiterSettings:
    """The values of the four parameters; the defaults are those of the exercise."""

    robot_name: str = "default_robot"
    max_velocity: float = 1.0  # m/s
    wheel_diameter: float = 0.1  # m
    enabled: bool = True


DEFAULTS = LimiterSettings()


def is_valid(name: str, value: Any) -> bool:
    """Whether a parameter may have a value of its type."""
    low, high = BOUNDS.get(name, (0.0, 0.0))
    return bool(low <= value <= high and value > 0.0 if name in BOUNDS else value != "")


class Reaction(NamedTuple):
    """What comes out for one command: the fields of /cmd_vel in the order of geometry_msgs/Twist, and /wheel_speed."""

    fields: tuple[float, ...]
    wheel: float

    def __str__(self) -> str:
        """As the learner is shown it."""
        return f"/cmd_vel {describe_fields(self.fields)}; /wheel_speed {self.wheel:.6g}"


def describe_fields(fields: Sequence[float]) -> str:
    """The fields of a geometry_msgs/Twist that are not 0."""
    return ", ".join(f"{name}={one:.6g}" for name, one in zip(NAMES, fields, strict=True) if one) or "all fields 0"


def right_reaction(settings: LimiterSettings, fields: Sequence[float]) -> Reaction:
    """What has to come out for a command with these fields."""
    if not settings.enabled:
        return Reaction((0.0,) * len(NAMES), 0.0)
    limited = min(max(fields[0], -settings.max_velocity), settings.max_velocity)
    return Reaction((limited, *fields[1:]), _ratio(limited, settings.wheel_diameter / 2.0))


def cause_of(
    settings: LimiterSettings, fields: Sequence[float], got: Reaction, *, floors: bool
) -> tuple[str, str | None, str]:
    """What is wrong with a reaction to a command: the check that it costs, the diagnosis, and what to say."""
    right = right_reaction(settings, fields)
    names = [name for name, mine, two in zip(NAMES, right.fields, got.fields, strict=True) if not are_same(mine, two)]
    if not settings.enabled:
        if names:
            return "change_enabled", None, "With enabled=False all of /cmd_vel has to be 0: the robot stands still."
        return "change_enabled", "math.formula", "With enabled=False the robot stands still, and so do its wheels."
    if others := [name for name in names if name != NAMES[0]]:
        hint = f"Only linear.x has to be limited; the other fields pass unchanged. Look at {' and '.join(others)}."
        return "limits", None, hint
    if names:
        hint = f"linear.x has to be {right.fields[0]:g} here, with max_velocity={settings.max_velocity:g}."
        if are_same(got.fields[0], fields[0]):
            hint = f"linear.x passed unchanged, although it is beyond max_velocity={settings.max_velocity:g}."
        elif are_same(got.fields[0], -right.fields[0]):
            hint = "The size is right but the sign is wrong: a command to drive backwards must still drive backwards."
        return "limits", "math.formula", hint
    speed, diameter, asked = got.fields[0], settings.wheel_diameter, fields[0]
    slips = (
        (_ratio(speed, diameter), "This is the speed divided by the diameter; the radius is half of it."),
        (speed * diameter / 2.0, "This is the speed times the radius; the smaller a wheel, the faster it turns."),
        (_ratio(speed, diameter) / 2.0, "This is a quarter: divide the speed by (diameter / 2), with the brackets."),
        (_ratio(speed, math.pi * diameter), "These are turns per second; the topic wants rad/s."),
        (_ratio(asked, diameter / 2.0), "This belongs to the command that came in, not to the one you have published."),
        (_ratio(-speed, diameter / 2.0), "The sign is wrong: a wheel that turns backwards has a negative speed."),
        (speed, "This is the speed itself, in m/s; the topic wants rad/s."),
    )
    usual = [hint for value, hint in slips if are_same(got.wheel, value)]
    if not usual and abs(got.wheel - right.wheel) <= 1.0 and (got.wheel == round(got.wheel) or floors):
        return "wheel_speed", "math.integer_division", "Digits were lost: look for //, int() and round()."
    none = "It matches none of the usual mistakes; work it out by hand: rad/s = (m/s) / radius in m."
    return "wheel_speed", "math.formula", (usual or [none])[0]


def read_status(text: str) -> tuple[str, float] | None:
    """Name and velocity of a status line, or None when it is none."""
    name, colon, number = text.rstrip().removesuffix("m/s").rpartition(":")
    with suppress(ValueError):
        if colon and text.rstrip().endswith("m/s"):
            return name, float(number)
    return None


def missing_in_reason(name: str, value: Any, reason: str) -> str:
    """What a reason for refusing a value lacks, in words; nothing when it is complete."""
    if not reason.strip():
        return "It is empty."
    if name not in reason:
        return f"It does not name the parameter, {name}."
    numbers = {float(number) for number in _NUMBER.findall(reason)}
    if name in BOUNDS:
        low, high = BOUNDS[name]
        broken = {low} if value <= low else {high} if value > high else {low, high}
        near = [(number, end) for number in numbers - ({abs(value)} - broken) for end in broken]
        if not any(abs(number - end) <= _NEAR * max(end, BOUNDS["wheel_diameter"][0]) for number, end in near):
            return f"It does not name, as a number, the limit that {value!r} breaks: {RANGES[name]}."
    return ""


def _ratio(number: float, other: float) -> float:
    """A quotient, or NaN: the settings are a stranger's."""
    return number / other if other else math.nan


def twist_of(fields: list[float]) -> Twist:
    linear, angular = (Vector3(**dict(zip("xyz", part, strict=True))) for part in (fields[:3], fields[3:]))
    return Twist(linear=linear, angular=angular)


def _react(node: GradedNode, fields: list[float]) -> Reaction:
    """What comes out for a command."""
    node.send(COMMAND, twist_of(fields))
    return Reaction(_fields_of(node.expect(LIMITED)), node.expect(WHEEL).data)


class LimiterSteps(Model):
    """A velocity limiter: its settings, what was done to it, and what is asked of it."""

    def __init__(self, settings: LimiterSettings = DEFAULTS) -> None:
        self.settings = self.start = self.seen = settings
        self.past: list[tuple[Done, bool]] = []  # what was done, and whether it was refused
        self.heard_at: list[float] = []  # when lines of /status have come, for the end
        self.quiet_until = self.sent_at = self.answered_at = 0.0  # seconds of time.monotonic()
        self.is_control = self.was_late = False  # it only tells what goes right without something; one answer was late
        self.lines: int | None = None  # of /status when a later one was to tell the settings; None if one has since

    def begin(self, node: GradedNode) -> None:
        """Wrong defaults cost the points of one check alone; with `--attach` somebody else has set the node."""
        self.settings = self.start = self.seen = LimiterSettings(**node.get(*TYPES, of=NODE))

    def accept(self, node: GradedNode, values: dict[str, Any], breaks: str) -> None:
        """Valid values are accepted; of several that are not, one that is refused alone costs its own check."""
        if self.lines is not None and "robot_name" in values:  # what was to be seen on /status
            self.require_status(node)
        if values.get("enabled") is False and self.settings.enabled and Reaction not in node.context.conversations:
            self.drive(node, [0.05, *[0.0] * 5])  # what goes wrong with it on is not for the check of it off to say
        if values.get("enabled") and not self.settings.enabled:
            self.require_quiet(node, self.answered_at + _AT_ONCE_S - time.monotonic())
        change = node.set(values, of=NODE)
        for name in values if len(values) > 1 and not change.result.successful else ():
            self.accept(node, {name: values[name]}, CHANGES[name])
        try:
            change.accepted(breaks=breaks)
        except Failed as failed:
            raise self.blame(node, failed, lambda model: model.accept(node, values, breaks)) from None
        self.require_quick(node, change)
        self.keep_values(values)

    def require_quick(self, node: GradedNode, change: Change) -> None:
        """The answer to a change came in time, or comes when it is asked for again, the first time that one is late."""
        if "change_status" in self.lost:
            return
        if change.latency_s > ANSWER_S and not self.was_late:  # a busy machine may have kept one waiting
            self.was_late, change = True, node.set(change.values, of=NODE)
        change.within(ANSWER_S, breaks="change_answered")

    def keep_values(self, values: dict[str, Any]) -> None:
        """The node has accepted these values."""
        self.settings = replace(self.settings, **values)
        self.past.append((values, False))
        if set(values) != {"robot_name"}:
            self.quiet_until = time.monotonic() + _ACTS_S

    def refuse(self, node: GradedNode, values: dict[str, Any]) -> None:
        """An invalid value, by itself or beside valid ones, is refused with a reason that names it and its range."""
        wrong = [name for name, value in values.items() if not is_valid(name, value)]
        name, several, change = wrong[0], len(values) > 1, node.set(values, of=NODE)
        if several and change.result.successful:
            invalid = {name: values[name] for name in wrong}
            node.set(invalid, of=NODE).refused(breaks="refused")
            why = f"Your node refuses {describe_value(invalid)} by itself, and accepts it beside others: judge all."
            change.fail(why, expected="refused, and nothing changed", breaks="atomic", diagnosis="validation.missing")
        change.refused(expected=f"refused: {RANGES[name]}", breaks="refused")
        self.past.append((values, True))
        self.require_quick(node, change)
        if "reason" in self.lost:
            return
        if not any(name in change.result.reason for name in wrong):  # who minds something else has named that
            valid = {**values, **{name: getattr(self.settings, name) for name in wrong}}
            self.accept(node, valid, "atomic" if several else CHANGES[name])
        if lacks := missing_in_reason(name, values[name], change.result.reason):
            why = f"Your node was right to refuse, but the reason has to say why. {lacks}"
            expected = f"refused, with a reason that names the parameter and its range ({RANGES[name]})"
            change.fail(why, expected=expected, breaks="reason", diagnosis="validation.no_reason")

    def require_quiet(self, node: GradedNode, seconds: float, *, enabled: bool = False) -> None:
        """Nothing comes that was not asked for, after a command while the robot was on or off."""
        on = enabled or self.seen.enabled
        if "one_each" in self.lost or ("change_enabled" in self.lost and not on):
            node.context.wait_until(lambda: False, _SOON_S)  # else one message too many is taken for the next answer
            return
        breaks, why = ("one_each", _ONCE) if on else ("one_each_disabled", f"{_ONCE} With enabled=False, too.")
        node.expect_nothing(LIMITED, WHEEL, seconds=seconds, why=why, breaks=breaks)

    def require_effect(self, node: GradedNode, name: str, *values: float) -> None:
        """Whoever calculates wrongly calculates something else after a change; else no change of it can be seen."""
        came = []
        for value in values:
            self.accept(node, {name: value}, CHANGES[name])
            self.require_quiet(node, _ACTS_S, enabled=True)
            came.append("; ".join(str(_react(node, [speed, *[0.0] * 5])) for speed in (BEYOND, -BEYOND)))
        if came[0] == came[1]:
            sent = f"set {name}={values[0]}, then {values[1]}; after each {COMMAND}: linear.x={BEYOND}, then {-BEYOND}"
            raise Failed(Evidence(sent, "something else after the change", came[1]), _NO_EFFECT, breaks=CHANGES[name])

    def require_values(self, node: GradedNode, sent: str = "") -> None:
        """The parameters have the values that the model has."""
        read, wanted = node.get(*TYPES, of=NODE), vars(self.settings)
        changed = [name for name, value in read.items() if (type(value), value) != (type(wanted[name]), wanted[name])]
        if not changed:
            return
        evidence = Evidence(sent or "get_parameters", describe_value(wanted), describe_value(read))
        why = "Your node accepted the value, but afterwards the parameter has a different one."
        raise Failed(evidence, why, breaks=CHANGES[changed[0]])

    def drive(self, node: GradedNode, fields: list[float], sent: str = "") -> None:
        """A command brings exactly one right message on each topic."""
        if "reacts" in self.lost:
            return
        if self.settings.enabled and fields != _PLAIN and Reaction not in node.context.conversations:
            self.drive(node, _PLAIN)  # first, so that who does not react to a special command loses only that
        if "limits" in self.lost:
            fields = [0.4 * self.settings.max_velocity, *[0.0] * 5]
        node.context.wait_until(lambda: time.monotonic() >= self.quiet_until, 2.0)
        # Only what has come already: what comes later is one too many for the next command, or at the end.
        self.require_quiet(node, 0.0, enabled=self.settings.enabled)
        self.sent_at = time.monotonic()
        node.send(COMMAND, twist_of(fields))
        heard = Reaction in node.context.conversations  # in this grading, whatever the start
        silent = "one_each_disabled" if not self.settings.enabled else "one_each" if heard else "within_3_s"
        try:
            twist = node.expect(LIMITED, breaks=silent, within_s=1.0 if "one_each" in self.lost else MESSAGE_S)
            wheel = node.expect(WHEEL, breaks=silent)
        except Failed as silence:
            if heard and silence.diagnosis == "topic.silent":  # which is about names
                silence.diagnosis = None
            self.blame_silence(node, silence, fields)
            return
        self.answered_at, node.context.conversations[Reaction] = time.monotonic(), True
        got = Reaction(_fields_of(twist), wheel.data)
        if self.is_right(self.settings, fields, got):
            self.seen = self.settings
            self.past.append((fields, False))
            return
        if "one_each" not in self.lost:
            node.expect_nothing(LIMITED, WHEEL, seconds=_SOON_S, why=_ONCE, breaks="one_each")
        text = "; ".join(filter(None, (sent, f"{COMMAND}: {describe_fields(fields)}")))
        evidence = Evidence(text, str(right_reaction(self.settings, fields)), str(got))
        failed = self.explain_reaction(node, evidence, fields, got)
        if self.is_control or failed.breaks not in self.lost:
            raise self.blame(node, failed, lambda model: model.drive(node, fields))

    def is_right(self, settings: LimiterSettings, fields: list[float], got: Reaction, *, wheel: bool = True) -> bool:
        judged = slice(2 if wheel and "wheel_speed" not in self.lost else 1)  # of a reaction
        return are_same(right_reaction(settings, fields)[judged], got[judged])

    def blame_silence(self, node: GradedNode, silence: Failed, fields: list[float]) -> None:
        """Say whose fault it is that a command brought nothing, unless it is that of a check that is lost."""
        if not self.settings.enabled and node.context.job.mode != "attach":
            on = [done if isinstance(done, list) else {**done, "enabled": True} for done, _ in self.past]
            if not self._goes_right(node, lambda model: model.drive(node, fields), on):
                silence.breaks = "one_each"  # who loses a command when enabled, too, does not lose it by that
        if self.is_control or silence.breaks not in self.lost:
            raise self.blame(node, silence, lambda model: model.drive(node, fields))

    def explain_reaction(self, node: GradedNode, evidence: Evidence, fields: list[float], got: Reaction) -> Failed:
        """Why a reaction is wrong, and whose points that costs."""
        now = self.settings
        drives = self.is_right(now, fields, got, wheel=False)  # if not, /cmd_vel alone tells which change is missing
        states = (vars(state).values() for state in (now, self.seen, self.start))
        for old in itertools.starmap(LimiterSettings, itertools.product(*zip(*states, strict=True))):
            names = [name for name in CHANGES if getattr(now, name) != getattr(old, name) and name != "robot_name"]
            if names and self.is_right(old, fields, got, wheel=drives):
                name = min(names, key=lambda name: CHANGES[name] in self.lost)
                evidence = replace(evidence, sent=f"set {name}={getattr(now, name)!r}; {evidence.sent}")
                late = not self.is_control and self._acts_later(node, fields)
                why = f" A second later it is right: a change has to act within {_ACTS_S:g} s." if late else ""
                unread = node.context.job.text.source.count(name) == 1  # where it is declared
                code = None if late or unread else "parameter.read_once"
                return Failed(evidence, f"{_NO_EFFECT}{why}", code, breaks=CHANGES[name])
        others = [done for done, _ in self.past if isinstance(done, list) or "enabled" not in done]
        stands = now.enabled and len(others) < len(self.past) and got == Reaction((0.0,) * len(NAMES), 0.0)
        if stands and (self.is_control or self._goes_right(node, lambda model: model.drive(node, fields), others)):
            why = "enabled is True, but the robot stands still, as with enabled=False."
            return Failed(evidence, why, breaks=CHANGES["enabled"])
        breaks, diagnosis, why = cause_of(now, fields, got, floors=node.context.job.text.facts.floor_divides)
        return Failed(evidence, why, diagnosis, breaks=breaks)

    def _acts_later(self, node: GradedNode, fields: list[float]) -> bool:
        """Whether the same command is treated rightly a second later."""
        with node.context.record.looking_away(), suppress(Failed):
            node.context.wait_until(lambda: False, ANSWER_S)
            return self.is_right(self.settings, fields, _react(node, fields))
        return False

    def blame(self, node: GradedNode, failed: Failed, act: Callable[[LimiterSteps], None]) -> Failed:
        """The fault of refused changes, or of a set of several, where it goes right on a fresh start without them."""
        past = [done for done, _ in self.past]
        refused = [done for done, was_refused in self.past if was_refused]
        plain = [done for done, was_refused in self.past if not was_refused]
        several = any(isinstance(done, dict) and len(done) > 1 for done in plain)
        if self.is_control or not (refused or several) or self._goes_right(node, act, past):
            return failed  # the last: it came by chance, or is a matter of time
        if not refused or not self._goes_right(node, act, plain):
            if not several or not self._goes_right(node, act, plain, apart=True):
                return failed
            why = "Values that were set together do not act as they do when you set one after the other."
            return Failed(failed.evidence, why, breaks="atomic")
        alone: list[Done] = []  # of what was refused only the wrong values, one at a time
        for done, was_refused in self.past:
            parts = done.items() if was_refused and isinstance(done, dict) and len(done) > 1 else ()
            alone += [{name: value} for name, value in parts if not is_valid(name, value)] if parts else [done]
        why = "Since your node refused an invalid change it behaves differently. It must behave as before."
        if any(len(done) > 1 for done in refused) and self._goes_right(node, act, alone):
            return Failed(failed.evidence, why, "parameter.not_atomic", breaks="atomic")
        return Failed(failed.evidence, why, breaks="refuses")

    def _goes_right(
        self, node: GradedNode, act: Callable[[LimiterSteps], None], past: Sequence[Done], *, apart: bool = False
    ) -> bool:
        """Whether an act is right on a fresh start after these commands and changes, `apart` one value at a time."""
        if node.context.job.mode == "attach":
            return False
        with node.context.record.looking_away():
            node.context.spoil()
            node.ensure_running()
            model, status = type(self)(), node.inbox(STATUS)
            model.is_control, model.lost, named = True, self.lost, [done for done in past if "robot_name" in done]
            try:
                model.begin(node)
                for done in past:
                    if done in named[-1:]:  # a line tells what was before: then it is a change of the name alone
                        node.context.wait_until(lambda before=status.count: status.count > before, _LINE_S)  # type: ignore[misc]
                    if isinstance(done, list):
                        _react(node, done)
                        continue
                    for values in [{name: value} for name, value in done.items()] if apart else [done]:
                        if node.set(values, of=NODE).result.successful:
                            model.keep_values(values)
                act(model)
            except Failed:
                return False
        return True

    def require_status(self, node: GradedNode, sent: str = "") -> None:
        """A line of /status tells the settings, within a second of a change."""
        context, inbox = node.context, node.inbox(STATUS)
        asked, self.lines = inbox.count if self.lines is None else self.lines, None
        if self.lost & {"status", "change_status"}:
            return
        changed, clock = self.settings != self.start, context.clock()

        def fits() -> bool:
            wanted = (self.settings.robot_name, self.settings.max_velocity)
            return any(read_status(str(status.data)) == wanted for status in inbox.newer_than(asked))

        if context.wait_until(fits, _LINE_S + _ACTS_S):
            context.record.begin_exchange().add_received(f"{STATUS}: {str(inbox.messages[-1].data)!r}", "message")
            return
        silent = inbox.count == asked and not context.wait_until(lambda: inbox.count > asked, SILENT_S - clock.wall_s())
        line = str(inbox.messages[-1].data) if inbox.count else ""
        got, read = f"on {STATUS}: {line!r}", read_status(line)
        breaks, code = "change_status" if changed and read is not None else "status", None
        if silent:
            got, why = f"nothing within {SILENT_S:g} s", "/status has to be published twice a second, by a timer."
            breaks, code = "" if inbox.count else "status", "topic.silent"
        elif read is None:
            why = "The line has to have the form <name>: <max_velocity> m/s, with a number in place of <max_velocity>."
        elif read[0] != self.settings.robot_name:
            why = f"The line begins with {read[0]!r}; robot_name is {self.settings.robot_name!r}."
            code = "parameter.read_once" if changed and read[0] == self.start.robot_name else None
        else:
            why = f"The line says {read[1]!r} m/s; max_velocity is {self.settings.max_velocity!r}, unrounded."
            code = "parameter.read_once" if changed and read[1] == self.start.max_velocity else None
        changes = [f"set {describe_value(done)}" for done, _ in self.past if isinstance(done, dict)]
        sent = sent or (changes or [""])[-1]
        wanted = f"on {STATUS}: '{self.settings.robot_name}: {self.settings.max_velocity!r} m/s'"
        failed = Failed(Evidence(sent, wanted, got), why, code, breaks=breaks)
        raise self.blame(node, failed, lambda model: model.require_status(node))

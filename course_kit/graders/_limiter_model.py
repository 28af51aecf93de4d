"""Exercise 3's velocity limiter as a conversation sees it: a model beside the node, and the steps with both.

What a parameter does is judged by what comes out on the topics, 0.2 s after a change was confirmed.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.graders._limiter import (
    BEYOND,
    DEFAULTS,
    RANGES,
    TYPES,
    LimiterSettings,
    Reaction,
    cause_of,
    command_of,
    is_valid,
    missing_in_reason,
    read_status,
    right_reaction,
    same_reaction,
    same_velocity,
    status_line,
    twist_of,
    what_is_wrong_with_status,
)
from course_kit.grading.checks.parameters import shown
from course_kit.grading.checks.vocabulary import (
    Change,
    Evidence,
    Failed,
    GradedNode,
    Model,
    between,
    drawn,
    either,
    rule,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping


NODE, COMMAND, LIMITED, WHEEL, STATUS = "/velocity_limiter", "/cmd_vel_in", "/cmd_vel", "/wheel_speed", "/status"
SILENT_S = 2.0  # four periods
_ACTS_S = 0.2  # after a change was confirmed it acts on every command that is sent
_ANSWER_S = 1.0  # of a change
_LINE_S = 1.0  # in which a change shows on /status
_NAN, _INF = math.nan, math.inf
_ONCE = "Publish once for each command, in the callback that receives it, and never without one."
_SOON_S, _LATE_S = 0.15, 0.5  # how long what was not asked for is waited for: when something is wrong, and at the end
_VELOCITIES = (-1.0, 0.0, 5.0001, 7.5, _NAN, _INF, -_INF)
_DIAMETERS = (0.0, -0.1, 0.0099, 1.0001, 20.0, _NAN, _INF, -_INF)
_NAMES = (" ", "my robot: 2", "Zo\u00eb \u83ef")
_INVALID = (
    *({"max_velocity": value} for value in _VELOCITIES),
    *({"wheel_diameter": value} for value in _DIAMETERS),
    {"robot_name": ""},
)
_TOGETHER = (
    {"max_velocity": 2.5, "wheel_diameter": 2.0},
    {"wheel_diameter": 0.5, "max_velocity": 6.0},
    {"wheel_diameter": 0.5, "max_velocity": 0.0},
    {"wheel_diameter": _NAN, "max_velocity": 0.7},
    {"max_velocity": 1.5, "robot_name": ""},
    {"enabled": False, "max_velocity": -1.0},
    {"enabled": False, "max_velocity": 0.0},
    {"enabled": False, "robot_name": ""},
    {"enabled": False, "wheel_diameter": 0.3, "max_velocity": 8.0},
    {"max_velocity": 8.0, "enabled": False},
    {"robot_name": "", "wheel_diameter": 0.4},
)
_WITH_NAMES = (
    {"robot_name": "half", "max_velocity": 0.0},
    {"robot_name": "half_2", "wheel_diameter": 0.0},
    {"enabled": False, "robot_name": "half_3", "wheel_diameter": 0.3, "max_velocity": 8.0},
)
_COMMANDS = (("m/s", 0.0, [0.0] * 5), ("m/s", 0.05, [0.0] * 5), ("m/s", 8.0, [0.0] * 5), ("m/s", -8.0, [0.5] * 5))


class Limiter(Model):
    """A velocity limiter: its settings, and what a refused change would have made of them."""

    def __init__(self, settings: LimiterSettings = DEFAULTS) -> None:
        self.settings = self.start = self.seen = settings
        self.refused: list[dict[str, Any]] = []
        self.past: list[dict[str, Any] | list[float]] = []  # changes that were accepted, and commands
        self.quiet_until = 0.0

    def begin(self, node: GradedNode) -> None:
        """Wrong defaults cost the points of their own check alone; with `--attach` somebody else has set the node."""
        self.settings = self.start = self.seen = LimiterSettings(**node.get(*TYPES, of=NODE))

    def end(self, node: GradedNode) -> None:
        """After all of it the node does what it did; and nothing comes late."""
        if not self.lost & set(_CHANGES.values()):
            self.several(node, {"robot_name": "last", "max_velocity": 0.7, "wheel_diameter": 0.3, "enabled": True})
            self.drive(node, [BEYOND, 0.1, 0.1, 0.1, 0.1, 0.1])
            self.drive(node, [0.05, 0.0, 0.0, 0.0, 0.0, 0.0])
            self.require_status(node)
        self.require_quiet(node, _LATE_S, enabled=True)
        if node.context.job.mode == "attach":
            node.set(self.start.to_mapping(), of=NODE)

    @rule("reacts", command=either(*_COMMANDS, drawn(command_of)))
    def look(self, node: GradedNode, command: tuple[str, float, list[float]]) -> None:
        """A command, when all changes act; and the parameters have their values."""
        self.require_values(node)
        kind, size, others = command
        self.drive(node, [size * self.settings.max_velocity if kind != "m/s" else size, *others])

    @rule("change_velocity", value=either(0.05, 1.23456789, between(0.1, 5.0)))
    def velocity(self, node: GradedNode, value: float) -> None:
        """A valid velocity."""
        self.accept(node, {"max_velocity": value}, "change_velocity")

    @rule("change_diameter", value=either(0.35, between(0.02, 0.9)))
    def diameter(self, node: GradedNode, value: float) -> None:
        """A valid diameter."""
        self.accept(node, {"wheel_diameter": value}, "change_diameter")

    @rule("change_velocity", values=either((5.0, 0.01), (0.001, 1.0), (0.5, 0.2), (between(2, 5), between(0.1, 0.9))))
    def both(self, node: GradedNode, values: tuple[float, float]) -> None:
        """Both numbers, one after the other, act."""
        velocity, diameter = values
        self.drive(node, [-BEYOND, 0.4, 0.3, 0.2, 0.1, -0.1])
        self.accept(node, {"max_velocity": float(velocity)}, "change_velocity")
        self.accept(node, {"wheel_diameter": diameter}, "change_diameter")
        self.drive(node, [-BEYOND, 0.4, 0.3, 0.2, 0.1, -0.1])

    @rule("change_enabled", value=either((True, 0.5), (False, 0.5), (False, 0.0)))
    def enable(self, node: GradedNode, value: tuple[bool, float]) -> None:
        """On and off act, on a command to stand still, too."""
        enabled, share = value
        self.accept(node, {"enabled": enabled}, "change_enabled")
        self.drive(node, [share * one for one in (self.settings.max_velocity, 0.2, 0.4, 0.6, 0.8, 1.0)])

    @rule("change_status", value=either(*_NAMES))
    def name(self, node: GradedNode, value: str) -> None:
        """A name, in any language."""
        self.accept(node, {"robot_name": value}, "change_status")
        if value != _NAMES[0] and not self.lost & {"status", "change_status"}:
            self.require_status(node)

    @rule(
        "atomic",
        values=either(
            {"max_velocity": between(0.2, 4.0), "wheel_diameter": between(0.02, 0.9)},
            {"wheel_diameter": between(0.02, 0.9), "robot_name": "both", "enabled": True},
            {"enabled": True, "max_velocity": between(0.2, 4.0), "robot_name": "all", "wheel_diameter": 0.25},
        ),
    )
    def several(self, node: GradedNode, values: dict[str, Any]) -> None:
        """Several valid values at once."""
        change = node.set(values, of=NODE)
        if not change.result.successful:
            for name, value in values.items():
                self.accept(node, {name: value}, _CHANGES[name])
        change.accepted(breaks="atomic")
        self.took(values)

    @rule("refuses", often=2 * len(_INVALID), values=either(*_INVALID))
    def refuse(self, node: GradedNode, values: dict[str, Any]) -> None:
        """An invalid value."""
        name = next(iter(values))
        change = node.set(values, of=NODE)
        change.refused(expected=f"refused: {RANGES[name]}")
        self.refused.append(values)
        self.in_time(change)
        self.require_reason(change, name, values[name])
        if name == "robot_name":
            self.require_status(node)

    def require_reason(self, change: Change, name: str, value: Any) -> None:
        """The reason of a refusal names the parameter and its range."""
        if lacks := missing_in_reason(name, value, change.result.reason):
            why = f"Your node was right to refuse, but the reason has to say why. {lacks}"
            expected = f"refused, with a reason that names the parameter and its range ({RANGES[name]})"
            change.fail(why, expected=expected, breaks="reason", diagnosis="validation.no_reason")

    @rule("refuses", values=either({"max_velocity": 8.0}, {"robot_name": ""}))
    def refuse_and_drive(self, node: GradedNode, values: dict[str, Any]) -> None:
        """What is refused neither stops the robot nor lets it drive again."""
        for enabled in (False, True) if "change_enabled" not in self.lost else ():
            self.accept(node, {"enabled": enabled}, "change_enabled")
            self.refuse(node, values)
            self.drive(node, [BEYOND, -0.1, -0.2, -0.3, -0.4, -0.5])

    @rule("atomic", sets=either(*(_TOGETHER[place::3] for place in range(3))))
    def refuse_together(self, node: GradedNode, sets: tuple[dict[str, Any], ...]) -> None:
        """Valid and invalid values at once; what is refused does not act."""
        if not self.settings.enabled and "change_enabled" not in self.lost:
            self.accept(node, {"enabled": True}, "change_enabled")
        self.drive(node, [BEYOND, -0.1, -0.2, -0.3, -0.4, -0.5])
        for values in sets:
            self.refuse_set(node, values)
        self.drive(node, [BEYOND, -0.1, -0.2, -0.3, -0.4, -0.5])

    @rule("atomic", sets=either(_WITH_NAMES))
    def refuse_names(self, node: GradedNode, sets: tuple[dict[str, Any], ...]) -> None:
        """Refused names do not show."""
        self.require_status(node)
        for values in sets:
            self.refuse_set(node, values)
        self.require_status(node)

    def refuse_set(self, node: GradedNode, values: dict[str, Any]) -> None:
        """Valid and invalid values at once are refused."""
        wrong = {name: value for name, value in values.items() if not is_valid(name, value)}
        change = node.set(values, of=NODE)
        if change.result.successful:
            alone = node.set(wrong, of=NODE)
            alone.refused(expected="refused", breaks="refused")
            why = (
                f"Your node refuses {shown(wrong)} by itself, and accepts it beside another value: judge each of them."
            )
            change.fail(why, expected="refused, and nothing changed", diagnosis="validation.missing")
        change.refused(expected=f"refused, and nothing changed: {shown(wrong)} is not valid")
        self.refused.append(values)
        if not any(name in change.result.reason for name in wrong):
            for name in values.keys() - wrong.keys():  # whoever minds this one has named it rightly
                self.accept(node, {name: values[name]}, _CHANGES[name])
            self.require_reason(change, *next(iter(wrong.items())))

    @rule(
        "wrong_type",
        values=either(
            {"max_velocity": "fast"},
            {"max_velocity": 2},
            {"enabled": 1},
            {"enabled": "yes"},
            {"robot_name": 7},
            {"wheel_diameter": 1},
        ),
    )
    def other_type(self, node: GradedNode, values: dict[str, Any]) -> None:
        """A value of another type."""
        name = next(iter(values))
        node.set(values, of=NODE).refused(expected=f"refused: {name} is a {TYPES[name]}", diagnosis="parameter.type")
        self.refused.append(values)

    @rule("undeclared", values=either({"wheel_count": 4}, {"max_velocity_": 1.0}))
    def undeclared(self, node: GradedNode, values: dict[str, Any]) -> None:
        """A parameter that is not declared."""
        node.set(values, of=NODE).refused(expected="refused: it is not declared", diagnosis="parameter.undeclared")

    @rule("status")
    def status(self, node: GradedNode) -> None:
        """The next line shows the name and the velocity."""
        self.require_status(node)

    def accept(self, node: GradedNode, values: dict[str, Any], breaks: str) -> None:
        """Valid values are accepted."""
        if values.get("enabled") and not self.settings.enabled:
            self.require_quiet(node, _SOON_S)
        change = node.set(values, of=NODE)
        change.accepted(breaks=breaks)
        self.in_time(change)
        self.took(values)

    def require_quiet(self, node: GradedNode, seconds: float, *, enabled: bool = False) -> None:
        """Nothing comes that was not asked for, after a command while the robot was on or off."""
        if self.lost & {"one_each", "change_enabled"}:  # else one message too many is taken for the next answer
            node.context.wait_until(lambda: False, _SOON_S)
            return
        on = enabled or self.seen.enabled
        off = "one_each" if on else "one_each_disabled"
        why = _ONCE if on else f"{_ONCE} With enabled=False, too."
        node.expect_nothing(LIMITED, WHEEL, seconds=seconds, why=why, breaks=off)

    def in_time(self, change: Change) -> None:
        """The answer to a change came within a second."""
        if "change_status" not in self.lost:
            change.within(_ANSWER_S, breaks="change_answered")

    def took(self, values: dict[str, Any]) -> None:
        """The node has accepted these values."""
        self.settings = replace(self.settings, **values)
        self.past.append(values)
        if set(values) != {"robot_name"}:
            self.quiet_until = time.monotonic() + _ACTS_S

    def require_values(self, node: GradedNode, sent: str = "") -> None:
        """The parameters have the values that the model has.

        Raises:
            Failed: one has not.
        """
        read = node.get(*TYPES, of=NODE)
        wanted = self.settings.to_mapping()
        if all(type(read[name]) is type(value) and read[name] == value for name, value in wanted.items()):
            return
        changed = {name: value for name, value in read.items() if value != wanted[name]}
        evidence = Evidence(sent or "get_parameters", shown(wanted), shown(read))
        for values in reversed(self.refused):
            if changed.items() <= values.items() or any(name in values for name in changed):
                why = "The parameter has changed although the change was refused."
                raise Failed(evidence, why, "parameter.not_atomic", breaks=_refused_by(values))
        why = "Your node accepted the value, but afterwards the parameter has another one."
        raise Failed(evidence, why, breaks=_CHANGES[next(iter(changed))])

    def drive(self, node: GradedNode, fields: list[float], sent: str = "") -> None:
        """A command brings exactly one right message on each topic.

        Raises:
            Failed: it does not.
        """
        context = node.context
        if "limits" in self.lost:
            fields = [abs(fields[0]) % self.settings.max_velocity, *[0.0] * 5]
        context.wait_until(lambda: time.monotonic() >= self.quiet_until, 2.0)
        self.require_quiet(node, 0.0, enabled=self.settings.enabled)
        self.past.append(fields)
        node.send(COMMAND, twist_of(fields))
        silent = ("within_3_s" if any(fields) else "one_each") if self.settings.enabled else "one_each_disabled"
        got = Reaction.of(node.expect(LIMITED, breaks=silent), node.expect(WHEEL, breaks=silent))
        right = right_reaction(self.settings, fields)
        if same_reaction(right, got) or ("wheel_speed" in self.lost and same_velocity(right, got)):
            self.seen = self.settings
            return
        if "one_each" not in self.lost:
            node.expect_nothing(LIMITED, WHEEL, seconds=_SOON_S, why=_ONCE, breaks="one_each")
        told = "; ".join(filter(None, (sent, f"{COMMAND}: {_told(fields)}")))
        evidence = Evidence(told, right.shown(), got.shown())
        failed = self.wrong(evidence, fields, got, floors=context.job.facts.floor_divides)
        raise self.blame(node, failed, self.past[:-1], lambda model: model.drive(node, fields))

    def wrong(self, evidence: Evidence, fields: list[float], got: Reaction, *, floors: bool) -> Failed:
        """Why a reaction is wrong, and whose points that costs."""
        for one, values in self.settings.with_some(self.refused):
            if same_reaction(got, right_reaction(one, fields)):
                why = "Your node refused the change, yet it acts on it: it kept a value before it had checked all."
                return Failed(evidence, why, "parameter.not_atomic", breaks=_refused_by(values))
        now, before = self.settings, self.seen
        changed = [name for name in TYPES if now.of(name) != before.of(name)]
        for old in (before, self.start):
            if old != now and same_reaction(got, right_reaction(old, fields)):
                why = "Your node accepted the change, but what comes out is the same as before."
                names = [name for name in TYPES if now.of(name) != old.of(name) and name != "robot_name"]
                names.sort(key=lambda name: _CHANGES[name] in self.lost)
                code = "parameter.read_once"
                return Failed(evidence, why, code, breaks=_CHANGES[names[0]] if names else "limited")
        of_wheel, diagnosis, why = cause_of(now, fields, got, floors=floors)
        if not now.enabled:
            breaks = "disabled"
        elif "enabled" in changed and not (of_wheel and got.wheel):
            breaks, why = "change_enabled", f"After enabled=True: {why}"
        elif of_wheel:
            same = now.wheel_diameter == self.start.wheel_diameter or diagnosis == "math.integer_division"
            breaks = "wheels" if same else "change_diameter"
        else:
            same = now.max_velocity == self.start.max_velocity or diagnosis is None
            breaks = "limited" if same else "change_velocity"
        return Failed(evidence, why, diagnosis, breaks=breaks)

    def blame(
        self,
        node: GradedNode,
        failed: Failed,
        past: list[dict[str, Any] | list[float]],
        act: Callable[[Limiter], None],
    ) -> Failed:
        """What goes right on a fresh start without the changes that were refused is wrong because of them."""
        context = node.context
        if not self.refused or failed.diagnosis == "parameter.not_atomic" or context.job.mode == "attach":
            return failed
        with context.record.looking_away():
            context.spoil()
            node.meet()
            model = Limiter()
            model.lost = self.lost
            try:
                model.begin(node)
                for done in past:
                    if isinstance(done, dict):
                        node.set(done, of=NODE).accepted()
                        model.took(done)
                    else:
                        node.send(COMMAND, twist_of(done))
                        node.expect(LIMITED)
                        node.expect(WHEEL)
                act(model)
            except Failed:
                return failed
        why = "Your node refused the change, yet it acts on it: what it does is different from before."
        return Failed(failed.evidence, why, "parameter.not_atomic", breaks=_refused_by(self.refused[-1]))

    def require_status(self, node: GradedNode, sent: str = "") -> None:
        """A line of /status tells the settings, within a second of a change.

        Raises:
            Failed: none does.
        """
        if self.lost & {"status", "change_status"}:
            return
        context, inbox = node.context, node.inbox(STATUS)
        changed = self.settings != self.start
        asked, clock = inbox.count, context.clock()

        def fits() -> bool:
            wanted = (self.settings.robot_name.strip(), self.settings.max_velocity)
            return any(read_status(str(one.data)) == wanted for one in inbox.since(asked))

        if context.wait_until(fits, _LINE_S + _ACTS_S):
            context.record.came(f"{STATUS}: {str(inbox.messages[-1].data)!r}")
            return
        evidence = Evidence(sent, f"on {STATUS}: {status_line(self.settings)}")
        if inbox.count == asked and not context.wait_until(lambda: inbox.count > asked, SILENT_S - clock.wall()):
            evidence = replace(evidence, got=f"nothing within {SILENT_S:g} s")
            why = "/status has to be published twice a second, by a timer."
            failed = Failed(evidence, why, "topic.silent", breaks="" if inbox.count else "status")
            raise self.blame(node, failed, self.past, lambda model: model.require_status(node))
        line = str(inbox.messages[-1].data)
        evidence = replace(evidence, got=f"on {STATUS}: {line}")
        read = read_status(line)
        for one, values in self.settings.with_some(self.refused):
            now = (self.settings.robot_name, self.settings.max_velocity)
            if (one.robot_name, one.max_velocity) != now and read == (one.robot_name.strip(), one.max_velocity):
                why = "Your node refused the change, yet /status shows it."
                raise Failed(evidence, why, "parameter.not_atomic", breaks=_refused_by(values))
        breaks, code = "change_status" if changed and read is not None else "status", None
        why = what_is_wrong_with_status(self.settings, line)
        if changed and read == (self.start.robot_name.strip(), self.start.max_velocity):
            why, code = "Your node accepted the change, but /status is the same as before.", "parameter.read_once"
        failed = Failed(evidence, why, code, breaks=breaks)
        raise self.blame(node, failed, self.past, lambda model: model.require_status(node))


_CHANGES = {
    "max_velocity": "change_velocity",
    "wheel_diameter": "change_diameter",
    "enabled": "change_enabled",
    "robot_name": "change_status",
}


def _refused_by(values: Mapping[str, Any]) -> str:
    """The check about a refused change."""
    return "atomic" if len(values) > 1 else "refuses"


def _told(fields: list[float]) -> str:
    return Reaction(tuple(fields), 0.0).shown_fields()

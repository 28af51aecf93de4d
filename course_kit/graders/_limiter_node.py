"""The velocity limiter of a submission as the grader meets it: its topics, its parameters, what a change must do."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, String

from course_kit.graders import _limiter
from course_kit.graders._limiter import TYPES, LimiterSettings, Reaction, same_reaction
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.parameters import Remote, SetResult, ensure_served, require_proper_answer, shown
from course_kit.grading.checks.topics import Topic, TopicExchange
from course_kit.grading.diagnosis.exceptions import explained

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

    from typing_extensions import Self

    from course_kit.grading.checks.context import CheckContext
    from course_kit.ros.topic import Inbox

NODE = "/velocity_limiter"
COMMAND = Topic("/cmd_vel_in", Twist)
LIMITED = Topic("/cmd_vel", Twist)
WHEEL = Topic("/wheel_speed", Float64)
STATUS = Topic("/status", String)
VELOCITY, WHEELS, BOTH = "velocity", "wheels", "both"
_TRIES = 2  # a node that follows its parameters through /parameter_events may be one message late
_QUIET_S = 0.8  # how long nothing more may come after the last answer; the timer for /status takes 0.5 s
_QUIET_STEP_S = 0.04  # only a message ends it earlier
_ACCEPTED = "accepted: the value is valid"


class Limiter:
    """The running submission; each check makes its own.

    As a context manager it puts the parameters back to what they were before: the next check, and with `--attach`
    the next grading, meets the node as this one did.
    """

    def __init__(self, context: CheckContext) -> None:
        """Meet the submission, started again if it has died.

        Raises:
            Failed: it does not come up again.
        """
        self._context = context
        self.remote: Remote = ensure_served(context, NODE)
        self._exchange, self.status = endpoints(context)

    def __enter__(self) -> Self:
        self._before = self.settings()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        context = self._context
        if self.remote.changed and not context.spoiled:
            # What is wrong with it was or will be said by the checks themselves.
            with suppress(Failed), context.record.looking_away(), context.after_the_verdict():
                self.remote.set_together(self._before.to_mapping())

    def settings(self) -> LimiterSettings:
        """The values in force, as the node's own services report them.

        Raises:
            Failed: one of them has another type than before.
        """
        found = self.remote.values(list(TYPES))
        if wrong := [f"{name} is {value.type}" for name, value in found.items() if value.type != TYPES[name]]:
            expected = ", ".join(f"{name}: {kind}" for name, kind in TYPES.items())
            message = f"{' and '.join(wrong)}. Until now each parameter had the right type."
            raise Failed(Evidence("get_parameters", expected, ", ".join(wrong)), message, "parameter.type")
        return LimiterSettings(**{name: value.value for name, value in found.items()})

    def require(self, values: Mapping[str, object], otherwise: Failed) -> LimiterSettings:
        """The settings, which hold these values.

        Args:
            values: by the parameters' names.
            otherwise: the verdict when they do not, but for what was got.

        Raises:
            Failed: they do not.
        """
        settings = self.settings()
        read = {name: value for name, value in settings.to_mapping().items() if name in values}
        if read != dict(values):
            raise Failed(replace(otherwise.evidence, got=shown(read)), otherwise.message, otherwise.diagnosis)
        return settings

    def driving(self) -> LimiterSettings:
        """What a check begins with: the settings, once `enabled` is true, as only then there is something to see."""
        return self._before if self._before.enabled else self.set(enabled=True)

    def set(self, **values: object) -> LimiterSettings:
        """Set valid values, one after the other; returns the settings after it.

        Raises:
            Failed: one was refused, or does not read back; with validation.overzealous or parameter.bad_callback.
        """
        for name, value in values.items():
            require_accepted(self.remote.set(name, value), {name: value})
        return self._require_accepted(values)

    def set_together(self, **values: object) -> LimiterSettings:
        """Set valid values at once; otherwise like `set`."""
        require_accepted(self.remote.set_together(values), values)
        return self._require_accepted(values)

    def react(self, twist: Twist, evidence: Evidence) -> Reaction:
        """What comes out for one command."""
        return Reaction.of(*self._exchange.send(twist, evidence))

    def count(self, commands: Sequence[Twist], evidence: Evidence) -> tuple[int, int]:
        """How many messages come on /cmd_vel and on /wheel_speed for commands of which each waits for its answers.

        What comes later counts as well: it is waited for longer than a timer of the exercise takes.

        Args:
            commands: sent one after the other, so that no queue overflows.
            evidence: what the check has so far.
        """
        self.react(Twist(), evidence)  # what an earlier command has left behind comes before
        before = [heard.count for heard in self._heard()]

        def counts() -> tuple[int, int]:
            velocities, wheels = (heard.count - count for heard, count in zip(self._heard(), before, strict=True))
            return velocities, wheels

        for twist in commands:
            self.react(twist, evidence)
        with explained(self._context, evidence):
            self._context.wait_until(lambda: max(counts()) > len(commands), _QUIET_S, step_s=_QUIET_STEP_S)
        return counts()

    def _heard(self) -> tuple[Inbox, Inbox]:
        hear = self._context.grader_node.inbox
        return (hear(LIMITED.interface, LIMITED.name), hear(WHEEL.interface, WHEEL.name))

    def expect(
        self, settings: LimiterSettings, twist: Twist, part: str, *, was: Reaction | None = None, sent: str = ""
    ) -> Evidence:
        """The command `twist` has the effect that the settings give it.

        Args:
            settings: the settings in force.
            twist: the command.
            part: VELOCITY, WHEELS or BOTH, what is looked at.
            was: what came out for the same command before a change; the same after it is parameter.read_once.
            sent: what was done before, for the evidence.

        Raises:
            Failed: it has not.
        """
        right = _limiter.right_reaction(settings, twist)
        evidence = Evidence("; ".join(filter(None, (sent, _limiter.shown(twist)))), _shown(right, part))
        for _ in range(_TRIES):
            got = self.react(twist, evidence)
            if not fits(settings, twist, part, got):
                got = self._better(lambda late: fits(settings, twist, part, late), evidence)
            if fits(settings, twist, part, got):
                return replace(evidence, got=_shown(got, part))
        evidence = replace(evidence, got=_shown(got, part))
        if was is not None and same_reaction(was, got):
            message = "Your node accepted the change, but what comes out is the same as before."
            raise Failed(evidence, message, "parameter.read_once")
        raise self._wrong(settings, twist, part, got, evidence)

    def _better(self, good: Callable[[Reaction], bool], evidence: Evidence) -> Reaction:
        return Reaction.of(*self._exchange.wait_for_better(lambda last: good(Reaction.of(*last)), evidence))

    def _wrong(self, settings: LimiterSettings, twist: Twist, part: str, got: Reaction, evidence: Evidence) -> Failed:
        if part != WHEELS and not _limiter.velocity_fits(settings, twist, got):
            diagnosis, message = _limiter.explain_velocity(settings, twist, got)
        else:
            diagnosis, message = _limiter.explain_wheel(
                settings, twist, got, floors=self._context.job.facts.floor_divides
            )
        return Failed(evidence, message, diagnosis)

    def _require_accepted(self, values: Mapping[str, object]) -> LimiterSettings:
        evidence = Evidence(shown(values), f"afterwards get_parameters says {shown(values)}")
        message = "Your node accepted the value, but afterwards the parameter has another one."
        return self.require(values, Failed(evidence, message))


def endpoints(context: CheckContext) -> tuple[TopicExchange, Inbox]:
    """The grader's ends of the four topics; the sooner they are made, the sooner they are connected."""
    return TopicExchange(context, COMMAND, (LIMITED, WHEEL)), context.grader_node.inbox(STATUS.interface, STATUS.name)


def drawn(context: CheckContext, low: float, high: float) -> float:
    """A value with one decimal place, which survives whatever format a status line is written in.

    Args:
        context: the check's, whose random numbers are drawn from.
        low: the smallest value.
        high: the largest value.
    """
    return round(context.random.uniform(low, high), 1)


def rest(context: CheckContext) -> dict[str, float]:
    """Values for the fields of a command that pass unchanged."""
    return {name: context.random.uniform(-1.0, 1.0) for name in ("linear_y", "linear_z", "angular_x", "angular_z")}


def fits(settings: LimiterSettings, twist: Twist, part: str, got: Reaction) -> bool:
    """Whether that part of a reaction is right.

    Args:
        settings: what the parameters were set to.
        twist: the command.
        part: which topic.
        got: what came for it.
    """
    velocity = part == WHEELS or _limiter.velocity_fits(settings, twist, got)
    return velocity and (part == VELOCITY or _limiter.wheel_fits(settings, got))


def require_accepted(outcome: SetResult, values: Mapping[str, object]) -> None:
    """A valid value was accepted.

    Raises:
        Failed: with validation.overzealous or parameter.bad_callback.
    """
    if outcome.successful:
        return
    evidence = Evidence(shown(values), _ACCEPTED, outcome.shown())
    require_proper_answer(outcome, evidence)
    raise Failed(evidence, f"Your node refused {shown(values)}, which is valid.", "validation.overzealous")


def require_refused(outcome: SetResult, values: Mapping[str, object], expected: str, accepted: str) -> Evidence:
    """A value was refused.

    Args:
        outcome: how the attempt went.
        values: what was tried.
        expected: in words.
        accepted: the code where it was accepted.

    Raises:
        Failed: with the code `accepted`, or parameter.bad_callback.
    """
    evidence = Evidence(shown(values), expected, outcome.shown())
    if outcome.successful:
        raise Failed(evidence, f"Your node accepted {shown(values)}.", accepted)
    return evidence


def _shown(reaction: Reaction, part: str) -> str:
    velocity, _, wheel = reaction.shown().partition("; ")
    return velocity if part == VELOCITY else reaction.shown() if part == BOTH else f"{wheel} ({velocity})"

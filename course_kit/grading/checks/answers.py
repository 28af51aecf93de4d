"""What came back from a learner's node, compared with what a check wants of it, and both in words."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.evidence import Evidence, Failed, charge_to, in_one_line
from course_kit.grading.diagnosis import causes
from course_kit.ros.filling import make_message
from course_kit.ros.messages import is_message_type, type_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros.messages import Message

UNFILLED = "The response still has its default values: your callback set none of its fields."
_RELATIVE, _ABSOLUTE = 1e-6, 1e-9  # the right formula, whatever has become of the last digits


@dataclass(frozen=True)
class Reply:
    """What came back for something that was sent.

    Attributes:
        sent: what was sent, in words.
        got: what came, in words.
        latency_s: after how many seconds.
    """

    sent: str
    got: str
    latency_s: float = 0.0

    def fail(self, why: str, *, expected: str, breaks: str = "", diagnosis: str | None = None) -> None:
        """End the check: what came is wrong.

        Args:
            why: what is wrong, in a sentence for the learner.
            expected: what a right node does, in words.
            breaks: the sentence of the exercise that is broken, where the check proves several.
            diagnosis: a code of the catalogue, where what was seen establishes it.

        Raises:
            Failed: always.

        Example:
            >>> answer = node.call("/area", radius=-1.0)
            >>> if answer.response.area < 0:
            ...     answer.fail("An area is never negative.", expected="an area of 0 or more")
        """
        raise Failed(Evidence(self.sent, expected, self.got), why, diagnosis, breaks=breaks)

    def within(self, seconds: float, *, breaks: str = "") -> None:
        """It took no longer than so many seconds.

        Args:
            seconds: the most that the exercise allows.
            breaks: as in `fail`.

        Raises:
            Failed: it took longer, with service.blocks.

        Example:
            >>> node.call("/add", a=1, b=2).within(1.5, breaks="quick")
        """
        if self.latency_s > seconds:
            why = f"The answer took {self.latency_s:.1f} s, and meanwhile every other client has to wait."
            self.fail(why, expected=f"an answer within {seconds:g} s", breaks=breaks, diagnosis="service.blocks")

    def not_before(self, seconds: float, *, breaks: str = "") -> None:
        """It took at least so many seconds: work that takes time was not left out.

        Args:
            seconds: the least that the exercise allows.
            breaks: as in `fail`.

        Raises:
            Failed: it came sooner.

        Example:
            >>> node.call("/weigh", a=1, b=2).not_before(0.4)
        """
        if self.latency_s < seconds:
            got, expected = f"it came after {self.latency_s:.2f} s", f"not before {seconds:g} s have passed"
            why = "This came too soon: the work takes longer, so it was not done."
            raise Failed(Evidence(self.sent, expected, got), why, breaks=breaks)


@dataclass(frozen=True)
class Answer(Reply):
    """The response of a service.

    Attributes:
        response: the message.
    """

    response: Any = None

    def expect(self, *, breaks: str = "", why: str = "", diagnosis: str | None = None, **fields: Any) -> Answer:
        """The response has these fields; others may hold anything.

        Args:
            breaks: the sentence of the exercise that a wrong answer breaks, where the check proves several.
            why: what is wrong with another answer, for the learner.
            diagnosis: its code of the catalogue.
            fields: a value for each; a dict for a message in it, or a function that says whether a value is right.

        Raises:
            Failed: one is not so.

        Example:
            >>> node.call("/add", a=1, b=2).expect(sum=3)
        """
        evidence = Evidence(self.sent, describe_value(fields), self.got)
        with charge_to(breaks):
            require_fields(fields, self.response, "In the response, ", evidence, why=why, diagnosis=diagnosis)
        return self

    def refused(self, *, reason: str = "message", what: str = "this request", breaks: str = "", **fields: Any) -> None:
        """The request was refused, with a reason.

        Args:
            reason: the field with the reason, which must not be blank; empty when the exercise asks for none.
            what: was wrong with the request, for the learner: "an unknown unit".
            breaks: as in `fail`.
            fields: by which a refusal is known; `success=False` when none are given.

        Raises:
            Failed: it was accepted, with validation.missing, or there is no reason, with validation.no_reason.

        Example:
            >>> node.call("/convert", value=1.0, unit="kelvin").refused(what="an unknown unit")
        """
        wanted = fields or {"success": False}
        expected = describe_value(wanted) + (f" and a {reason} that says why" if reason else "")
        if not are_same(wanted, self.response):
            why = f"Your service accepted {what}."
            self.fail(why, expected=expected, breaks=breaks, diagnosis="validation.missing")
        if reason and not getattr(self.response, reason).strip():
            why = f"Your service was right to refuse {what}, but its {reason} is empty: the client cannot tell why."
            self.fail(why, expected=expected, breaks=breaks, diagnosis="validation.no_reason")


@dataclass(frozen=True)
class Change(Reply):
    """The answer to a change of parameters.

    Attributes:
        values: what was to be set.
        result: whether it was, and the reason.
    """

    values: Any = None
    result: Any = None

    def accepted(self, *, breaks: str = "") -> None:
        """The change was accepted.

        Args:
            breaks: as in `fail`.

        Raises:
            Failed: it was refused, with validation.overzealous or parameter.bad_callback.

        Example:
            >>> node.set(max_speed=0.5).accepted()
        """
        if not self.result.successful:
            expected = "accepted: the value is valid"
            self._require_proper_answer(expected, breaks)
            if "undeclared parameter(s)" in self.result.reason:  # rclpy leaves out which
                why = f"Your node has not declared {', '.join(self.values)}."
                self.fail(why, expected=expected, breaks=breaks, diagnosis="parameter.undeclared")
            why = f"Your node refused {describe_value(self.values)}, which is valid."
            self.fail(why, expected=expected, breaks=breaks, diagnosis="validation.overzealous")

    def refused(self, *, expected: str = "refused", breaks: str = "", diagnosis: str = "validation.missing") -> None:
        """The change was refused.

        Args:
            expected: why, in words.
            breaks: as in `fail`.
            diagnosis: what it means that it was accepted.

        Raises:
            Failed: it was accepted, or rclpy refused it because the callback returned no result.

        Example:
            >>> node.set(max_speed=-1.0).refused(breaks="refused")
        """
        if self.result.successful:
            why = f"Your node accepted {describe_value(self.values)}, but it should refuse it."
            self.fail(why, expected=expected, breaks=breaks, diagnosis=diagnosis)
        self._require_proper_answer(expected)

    def _require_proper_answer(self, expected: str, breaks: str = "") -> None:
        """A refusal is the learner's own, not rclpy's for a callback that returned something else."""
        if causes.INVALID_RESULT in self.result.reason:
            why = "Your set-parameters callback did not return a SetParametersResult, so rclpy refused the change."
            self.fail(why, expected=expected, breaks=breaks, diagnosis="parameter.bad_callback")


@dataclass(frozen=True)
class Approximation:
    """A number that is expected with another accuracy than 1e-6 relative or 1e-9 absolute.

    Attributes:
        value: the number.
        absolute: how far off it may be.

    Example:
        >>> node.call("/area", radius=2.0).expect(area=Approximation(12.566, absolute=0.01))
    """

    value: float
    absolute: float

    def __call__(self, got: Any) -> bool:
        """Whether a number is close enough."""
        return math.isclose(got, self.value, rel_tol=0.0, abs_tol=self.absolute)


def differences(wanted: Any, got: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """The fields that are not as expected: path, what was wanted, what came."""
    if isinstance(wanted, dict):
        for name, value in wanted.items():
            yield from differences(value, getattr(got, name), f"{path}.{name}" if path else name)
    elif is_message_type(type(wanted)):
        for name in wanted.get_fields_and_field_types():
            yield from differences(getattr(wanted, name), getattr(got, name), f"{path}.{name}" if path else name)
    elif not _fits(wanted, got):
        yield path, wanted, got


def are_same(wanted: Any, got: Any) -> bool:
    """Whether all is as expected."""
    return not any(differences(wanted, got))


def require_fields(  # noqa: PLR0913 - what is looked at, and what is said of it
    wanted: Any, got: Any, where: str, evidence: Evidence, *, why: str = "", diagnosis: str | None = None
) -> None:
    """All is as expected; else that is said of the first field which is not, unless the check says why."""
    for path, right, other in differences(wanted, got):
        text = why or f"{where}{path} is {describe_value(other)}; it has to be {describe_value(right)}."
        raise Failed(evidence, text, diagnosis)


def _fits(wanted: Any, got: Any) -> bool:
    if callable(wanted):
        return bool(wanted(got))
    if isinstance(wanted, float):
        if math.isnan(wanted):
            return math.isnan(got)
        return math.isclose(wanted, got, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
    if isinstance(wanted, (list, tuple)):
        return len(wanted) == len(got) and all(map(_fits, wanted, got))
    return bool(wanted == got)


def describe_value(wanted: Any) -> str:
    """What is expected or came, in words: `success=True, value=32.0`."""
    if is_message_type(type(wanted)):
        return in_one_line(wanted)
    if isinstance(wanted, dict):
        return ", ".join(f"{name}={describe_value(value)}" for name, value in wanted.items())
    if isinstance(wanted, Approximation):
        return repr(wanted.value)
    return "what the task says" if callable(wanted) else repr(getattr(wanted, "tolist", lambda: wanted)())


def message_of(message_type: Any, given: Any, fields: dict[str, Any]) -> Message:
    """A message with the fields that somebody has written."""
    if isinstance(given, message_type):
        return given
    names = list(message_type.get_fields_and_field_types())
    if given is not None and not isinstance(given, dict):
        if len(names) != 1:
            raise TypeError(f"{type_name(message_type)} has {len(names)} fields: say which, as a dict")
        given = {names[0]: given}
    return make_message(message_type, {**(given or {}), **fields}, type_name(message_type))


def only_field(message: Message, wanted: Any) -> Any:
    """What is expected of a message, written as the value of its only field or not."""
    names = list(message.get_fields_and_field_types())
    whole = callable(wanted) and not isinstance(wanted, Approximation)
    if isinstance(wanted, dict) or whole or is_message_type(type(wanted)) or len(names) != 1:
        return wanted
    return {names[0]: wanted}

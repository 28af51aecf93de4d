"""Starts of a submission with values for its parameters, valid and invalid."""

from __future__ import annotations

import re
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from course_kit.graders._limiter import BEYOND, TYPES, LimiterSettings, command, parameter_file, right_reaction
from course_kit.graders._limiter import shown as shown_command
from course_kit.graders._limiter_node import BOTH, NODE, VELOCITY, Limiter, endpoints, fits
from course_kit.graders._limiter_status import expect_status
from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.parameters import expect_served, shown, start_arguments

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from course_kit.grading.checks.context import CheckContext

_FILE = "parameters.yaml"
_GIVEN = "given"  # remembered of a running submission: the values it was started with
_TOLD_S = 1.0  # what a program has printed arrives within milliseconds
_ENDED = ("start.crash", "start.exit")
# What rclpy says, from 7.1.10 on, of requests that somebody else has made.
_SAID_BY_RCLPY = re.compile(r"^.*\]: Failed to (?:describe|get|set) parameter.*$", re.MULTILINE)
_WARNINGS = ("[WARN]", "[ERROR]", "[FATAL]")


@dataclass(frozen=True)
class Given:
    """Values given at a start, by the parameters' names."""

    arguments: Mapping[str, object] = field(default_factory=dict)
    file: Mapping[str, object] = field(default_factory=dict)

    @property
    def words(self) -> list[str]:
        """What follows the program's name."""
        return [*start_arguments(self.arguments), *(["--params-file", _FILE] if self.file else [])]

    @property
    def files(self) -> dict[str, str]:
        """The text of the file, by its name."""
        return {_FILE: parameter_file(NODE, self.file)} if self.file else {}

    @property
    def shown(self) -> str:
        """As the learner is shown it."""
        return " ".join(self.words) + (f", in which {shown(self.file)}" if self.file else "")


def expect_arguments(context: CheckContext, given: Given) -> Evidence:
    """Values on the command line are in force.

    A program that has them right beside the values of a file runs on, for `expect_file`: a start costs more than all
    that is asked of it. Otherwise the verdict is on a start with the arguments alone.

    Args:
        context: the check's.
        given: what is given at the start.

    Raises:
        Failed: they are not; with parameter.override_ignored, or what `expect_served` says.
    """
    with suppress(Failed):
        evidence = _judge_arguments(context, given)
        context.memory[_GIVEN] = given
        return evidence
    context.record.clear()
    try:
        return _judge_arguments(context, Given(given.arguments))
    finally:
        context.spoil()  # whatever comes next needs a start without arguments


def expect_file(context: CheckContext, given: Given) -> Evidence:
    """Values in a file of parameters are in force, on the topics and in the status line.

    Args:
        context: the check's.
        given: what is given at the start; not with the arguments, unless such a program is running already.

    Raises:
        Failed: they are not; as in `expect_arguments`.
    """
    try:
        if not context.spoiled and context.memory.get(_GIVEN) == given:
            with suppress(Failed):
                return _judge_file(context, given, Limiter(context))
            context.record.clear()
        alone = Given(file=given.file)
        return _judge_file(context, alone, _start(context, alone))
    finally:
        context.spoil()


def expect_invalid(context: CheckContext, values: Mapping[str, object]) -> Evidence:
    """Each invalid value stops the node with an error, or is replaced by the default with a warning.

    Raises:
        Failed: it is taken, or its output does not say so; with validation.missing or validation.no_reason.
    """
    evidence = Evidence()
    for name, value in values.items():
        arguments = start_arguments({name: value})
        expected = f"an error that names {name} and the end of the program, or a warning and the default"
        evidence = Evidence(" ".join(arguments), expected)
        try:
            context.launch(arguments)
            evidence = _judge_invalid(context, name, value, evidence)
        finally:
            context.spoil()
    return evidence


def _judge_arguments(context: CheckContext, given: Given) -> Evidence:
    with _start(context, given) as limiter:
        _require_values(limiter, given.arguments, given.shown)
        return _require_effect(limiter, limiter.driving(), BOTH, given.shown)


def _judge_file(context: CheckContext, given: Given, limiter: Limiter) -> Evidence:
    settings = _require_values(limiter, given.file, given.shown)
    _require_effect(limiter, settings, VELOCITY, given.shown)
    return _ignoring(lambda: expect_status(context, limiter.status, settings, sent=given.shown))


def _start(context: CheckContext, given: Given) -> Limiter:
    context.launch(given.words, given.files)
    endpoints(context)
    try:
        expect_served(context, NODE)
    except Failed as failed:
        evidence = replace(failed.evidence, sent=given.shown)
        if failed.diagnosis in _ENDED and _names_a_parameter(context):
            message = f"Your program ended when it was started with valid values. {failed.message}"
            raise Failed(evidence, message, "validation.overzealous") from None
        raise Failed(evidence, failed.message, failed.diagnosis) from None
    return Limiter(context)


def _names_a_parameter(context: CheckContext) -> bool:
    """Whether the last words of a program are about a parameter, so that it has ended because of its value."""
    told = (
        context.process().stderr.rstrip().rpartition("\n")[2] or context.process().stdout.rstrip().rpartition("\n")[2]
    )
    return any(name in told for name in TYPES)


def _require_values(limiter: Limiter, values: Mapping[str, object], sent: str) -> LimiterSettings:
    message = "The program was started with these values, but its parameters have others."
    return limiter.require(values, Failed(Evidence(sent, shown(values)), message, "parameter.override_ignored"))


def _require_effect(limiter: Limiter, settings: LimiterSettings, part: str, sent: str) -> Evidence:
    return _ignoring(lambda: limiter.expect(settings, command(BEYOND), part, sent=sent))


def _ignoring(look: Callable[[], Evidence]) -> Evidence:
    """What was right in the first run and is wrong with a value given at the start goes back to that value."""
    try:
        return look()
    except Failed as failed:
        if failed.diagnosis not in (None, "math.formula"):
            raise
        message = f"The parameter has the value given at the start, but the node acts on another. {failed.message}"
        raise Failed(failed.evidence, message, "parameter.override_ignored") from None


def _judge_invalid(context: CheckContext, name: str, value: object, evidence: Evidence) -> Evidence:
    endpoints(context)
    try:
        expect_served(context, NODE)
    except Failed as failed:
        if context.process(fresh=True).running:
            raise Failed(replace(failed.evidence, sent=evidence.sent), failed.message, failed.diagnosis) from None
        return _require_told(context, (name,), replace(evidence, got="the program ended"))
    twist = command(BEYOND)
    got = Limiter(context).react(twist, replace(evidence, sent=f"{evidence.sent}; {shown_command(twist)}"))
    if not fits(LimiterSettings(), twist, BOTH, got):
        default = right_reaction(LimiterSettings(), twist)
        evidence = Evidence(
            f"{evidence.sent}; {shown_command(twist)}", f"{evidence.expected}: {default.shown()}", got.shown()
        )
        message = f"Your node started with {name}={value!r}, which it should have refused."
        raise Failed(evidence, message, "validation.missing")
    return _require_told(context, (name, *_WARNINGS), replace(evidence, got="it runs with the default"))


def _require_told(context: CheckContext, words: tuple[str, ...], evidence: Evidence) -> Evidence:
    """Somebody reads the terminal: it has to say what happened. By itself this earns nothing."""

    def told() -> bool:
        process = context.process(fresh=True)
        own = _SAID_BY_RCLPY.sub("", process.stdout + process.stderr)
        return any(word in own for word in words)

    if not context.wait_until(told, _TOLD_S, of_the_living=False):
        evidence = replace(evidence, got=f"{evidence.got}, and its output does not name {words[0]}")
        message = f"The program's output does not name {words[0]}, so its user cannot tell what was wrong."
        raise Failed(evidence, message, "validation.no_reason")
    return evidence

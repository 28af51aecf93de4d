"""Declared checks of topics: what comes on one for what is sent on another."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.around import made
from course_kit.grading.checks.declared.explaining import Exchanged, explained
from course_kit.grading.checks.declared.messages import (
    Tolerance,
    differences,
    plain,
    shown,
    shown_part,
    uses_parameters,
    worked_out,
)
from course_kit.grading.checks.declared.settings import served, values_in
from course_kit.grading.checks.declared.starting import ensure_up
from course_kit.grading.checks.declared.wanted import topic_of
from course_kit.grading.checks.topics import TopicExchange
from course_kit.grading.diagnosis.exceptions import explained as explained_end

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.checks.topics import Topic
    from course_kit.ros.messages import Message

_QUIET_S = 0.8  # how long nothing more may come after the last answer: longer than usual timers take


def topic_answers(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each message is answered by the one that is expected.

    Raises:
        Failed: by another, or by none.
    """
    ensure_up(context, check.endpoints)
    exchange, tolerance = answering(context, check), Tolerance.of(check.keys.get("tolerance"))
    exchanges: list[Exchanged] = []
    wrong: Exchanged | None = None
    cases = around.cases(check, context.job.seed)
    messages = [made(topic_of(check.endpoints["subscription"]).interface, one.fields, "the message") for one in cases]
    parameters = _parameters(context, check, {str(number): one.expected for number, one in enumerate(cases)})
    heard = context.grader_node.inbox(*_end_of(check))
    if check.keys.get("exactly_one"):  # what an earlier message has left behind comes before
        exchange.send(messages[0], _evidence(check, plain(messages[0]), "a message"))
    before = heard.count
    for number, (case, message) in enumerate(zip(cases, messages, strict=True)):
        names = {"message": plain(message), "parameters": parameters}
        wanted = worked_out(case.expected, {**names, **around.oracle(check, number)})
        one = exchanged(exchange, message, wanted, tolerance, _evidence(check, plain(message), wanted))
        exchanges.append(one)
        if wrong is None and not _fits(one, tolerance):
            wrong = one
    if wrong is not None:
        diagnosis, text = explained(wrong, exchanges, tolerance, floors=context.job.facts.floor_divides)
        raise Failed(_evidence(check, wrong.sent, wrong.wanted, wrong.got), text, diagnosis)
    if check.keys.get("exactly_one"):
        return _require_exactly_one(context, check, heard.count - before, exchanges)
    last = exchanges[-1]
    return _evidence(check, last.sent, last.wanted, last.got)


def _parameters(context: CheckContext, check: Declaration, expected: Any) -> dict[str, Any]:
    """The parameters in force, of which what is expected depends."""
    return values_in(served(context, check.node), expected) if uses_parameters(expected) else {}


def answering(context: CheckContext, check: Declaration) -> TopicExchange:
    """The grader's ends of the two topics of a check."""
    sent, heard = (topic_of(check.endpoints[end]) for end in ("subscription", "publisher"))
    return TopicExchange(context, sent, (heard,))


def exchanged(
    exchange: TopicExchange, message: Message, wanted: Any, tolerance: Tolerance, evidence: Evidence
) -> Exchanged:
    """Send a message and take what comes for it; a wrong one may be followed by the right one a moment later.

    Args:
        exchange: the topics.
        message: what to send.
        wanted: what is to come.
        tolerance: of floats.
        evidence: what the check has so far.

    Raises:
        Failed: nothing came.
    """

    def fits(last: tuple[Message, ...]) -> bool:
        return next(differences(wanted, plain(last[0]), tolerance), None) is None

    got = exchange.send(message, evidence, about=evidence.sent)
    if not fits(got):
        got = exchange.wait_for_better(fits, evidence)
    return Exchanged(plain(message), wanted, got[0])


def ask(context: CheckContext, check: Declaration, around: Around) -> list[Any]:
    """What the solution, which runs now, publishes for the messages of a check."""
    exchange, found = answering(context, check), []
    for case in around.cases(check, context.job.seed):
        message = made(topic_of(check.endpoints["subscription"]).interface, case.fields, "the message")
        evidence = Evidence(shown(plain(message)), "an answer of the solution")
        found.append(plain(exchange.send(message, evidence)[0]))
    return found


def _fits(one: Exchanged, tolerance: Tolerance) -> bool:
    return next(differences(one.wanted, plain(one.got), tolerance), None) is None


def _end_of(check: Declaration) -> tuple[Any, str]:
    topic: Topic = topic_of(check.endpoints["publisher"])
    return topic.interface, topic.name


def _evidence(check: Declaration, sent: Mapping[str, Any], wanted: Any, got: Message | None = None) -> Evidence:
    there, back = (check.endpoints[end].name for end in ("subscription", "publisher"))
    told = "" if got is None else f"{back}: {shown(plain(got))}"
    expected = wanted if isinstance(wanted, str) else shown_part(wanted)  # in words where anything will do
    return Evidence(f"{there}: {shown(sent)}", f"{back}: {expected}", told)


def _require_exactly_one(context: CheckContext, check: Declaration, came: int, exchanges: list[Exchanged]) -> Evidence:
    """For each message one has come, and none comes later."""
    there, back = (check.endpoints[end].name for end in ("subscription", "publisher"))
    heard, count = context.grader_node.inbox(*_end_of(check)), len(exchanges)
    expected = f"{count} message{'s' * (count > 1)} on {back}, and none later"
    evidence = Evidence(f"{count} message{'s' * (count > 1)} on {there}, one after the other", expected)
    before = heard.count - came
    with explained_end(context, evidence):
        context.wait_until(lambda: heard.count - before > count, _QUIET_S)
    evidence = replace(evidence, got=f"{heard.count - before} messages on {back}")
    if heard.count - before != count:
        raise Failed(evidence, "Publish once for each message, in the callback that receives it.")
    return evidence

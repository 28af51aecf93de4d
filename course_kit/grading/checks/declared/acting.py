"""Declared checks of what a parameter does: it is set, then the node is asked, or heard, again."""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.around import InputCase, made
from course_kit.grading.checks.declared.explaining import Exchanged, explained
from course_kit.grading.checks.declared.inputs import drawn
from course_kit.grading.checks.declared.messages import Tolerance, differences, plain, shown, shown_part, worked_out
from course_kit.grading.checks.declared.settings import accept, put_back, require_values, served, values_in
from course_kit.grading.checks.declared.starting import ensure_up
from course_kit.grading.checks.declared.topics import answering, exchanged
from course_kit.grading.checks.declared.values import as_list
from course_kit.grading.checks.declared.wanted import meet, service_of, topic_of
from course_kit.grading.checks.parameters import expect_served, start_arguments
from course_kit.grading.checks.parameters import shown as shown_values
from course_kit.grading.checks.services import call
from course_kit.grading.diagnosis.exceptions import explained as explained_end
from course_kit.grading.diagnosis.hangs import told

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import TypeAlias

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.checks.parameters import Remote

    _Cases: TypeAlias = Sequence[tuple[InputCase, Mapping[str, Any]]]
    """Inputs, each with what expressions may call the solution's answer."""

_SILENT_S = 3.0  # how long the next message of a publisher is waited for
_ON_ITS_WAY = 2  # messages of a publisher: the one after a change may have been sent before it
_SAME = Tolerance()


def parameter_acts(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each setting has the effect that is expected.

    Raises:
        Failed: it has another, or none.
    """
    evidence = Evidence()
    settings = drawn(as_list(check.keys["set"]), context.job.seed, f"{check.id} set")
    cases = around.cases(check, context.job.seed) if _sends(check) else [InputCase({}, check.keys["expect"])]
    act = _at_start if check.keys.get("at_start") else _while_it_runs
    for number, values in enumerate(settings):
        oracle = [around.oracle(check, number * len(cases) + place) for place in range(len(cases))]
        evidence = act(context, check, values, list(zip(cases, oracle, strict=True)))
    return evidence


def _while_it_runs(context: CheckContext, check: Declaration, values: Mapping[str, Any], cases: _Cases) -> Evidence:
    ensure_up(context, check.endpoints)
    remote = served(context, check.node)
    with put_back(context, remote, values):
        before = [
            _observed(context, check, case, None, Evidence(_sent({}, check, case), _any(check))).got
            for case, _ in cases
        ]
        accept(remote, values)
        evidence, wrong = _look(context, check, remote, values, cases)
        if wrong is None:
            return evidence
        exchanges, number, tolerance = wrong
        one = exchanges[number]
        if next(differences(plain(before[number]), plain(one.got), _SAME), None) is None:
            message = "Your node accepted the change, but what comes out is the same as before."
            raise Failed(evidence, message, "parameter.read_once")
        diagnosis, message = explained(one, exchanges, tolerance, floors=context.job.facts.floor_divides)
        raise Failed(evidence, message, diagnosis)


def ask(context: CheckContext, check: Declaration, around: Around) -> list[Any]:
    """What comes out of the solution, which runs now, with each setting of a check."""
    found = []
    cases = around.cases(check, context.job.seed) if _sends(check) else [InputCase({}, "")]
    for values in drawn(as_list(check.keys["set"]), context.job.seed, f"{check.id} set"):
        remote = served(context, check.node)
        with put_back(context, remote, values):
            accept(remote, values)
            evidence = Evidence(shown_values(values), "an answer of the solution")
            found += [plain(_observed(context, check, case, None, evidence).got) for case in cases]
    return found


def _at_start(context: CheckContext, check: Declaration, values: Mapping[str, Any], cases: _Cases) -> Evidence:
    arguments = start_arguments(values)
    sent = " ".join(arguments)
    with ExitStack() as afterwards:
        afterwards.callback(context.spoil)  # whatever comes next needs a start without arguments
        context.launch(arguments)
        try:
            expect_served(context, check.node)
        except Failed as failed:
            raise Failed(replace(failed.evidence, sent=sent), failed.message, failed.diagnosis) from None
        meet(context, check.endpoints.values())
        remote = served(context, check.node)
        message = "The program was started with these values, but its parameters have others."
        require_values(remote, values, sent, message, "parameter.override_ignored")
        evidence, wrong = _look(context, check, remote, values, cases)
        if wrong is not None:
            exchanges, number, tolerance = wrong
            told = explained(exchanges[number], exchanges, tolerance, floors=context.job.facts.floor_divides)[1]
            message = f"The parameter has the value given at the start, but the node acts on another. {told}"
            raise Failed(evidence, message, "parameter.override_ignored")
        return evidence


def _look(
    context: CheckContext,
    check: Declaration,
    remote: Remote,
    values: Mapping[str, Any],
    cases: _Cases,
) -> tuple[Evidence, tuple[list[Exchanged], int, Tolerance] | None]:
    """What comes with the present settings: evidence of the first wrong exchange with all of them, else of the last."""
    tolerance = Tolerance.of(check.keys.get("tolerance"))
    parameters = values_in(remote, check.keys["expect"])
    exchanges: list[Exchanged] = []
    evidence = Evidence()
    wrong = None
    for number, (case, oracle) in enumerate(cases):
        sent = _plain_input(check, case)
        wanted = worked_out(case.expected, {**_named_input(check, sent), "parameters": parameters, **oracle})
        expected = Evidence(_sent(values, check, case), shown_part(wanted))
        exchanges.append(_observed(context, check, case, wanted, expected))
        if wrong is None:
            evidence = replace(expected, got=shown_part(plain(exchanges[-1].got), wanted))
            if next(differences(wanted, plain(exchanges[-1].got), tolerance), None) is not None:
                wrong = number
    return evidence, None if wrong is None else (exchanges, wrong, tolerance)


def _observed(context: CheckContext, check: Declaration, case: InputCase, wanted: Any, evidence: Evidence) -> Exchanged:
    """What comes for one input, or by itself."""
    tolerance = Tolerance.of(check.keys.get("tolerance"))
    if "service" in check.endpoints:
        service = service_of(check.endpoints["service"])
        request = made(service.interface.Request, case.fields, "the request")
        response = call(context, service, request, evidence.sent, evidence.expected or "an answer").response
        return Exchanged(plain(request), wanted, response)
    if "subscription" in check.endpoints:
        topic = topic_of(check.endpoints["subscription"])
        message = made(topic.interface, case.fields, "the message")
        return exchanged(answering(context, check), message, {} if wanted is None else wanted, tolerance, evidence)
    return _heard(context, check, wanted, tolerance, evidence)


def _any(check: Declaration) -> str:
    """What is expected where it does not matter yet what comes."""
    return "an answer" if "service" in check.endpoints else f"a message on {check.endpoints['publisher'].name}"


def _heard(
    context: CheckContext, check: Declaration, wanted: Any, tolerance: Tolerance, evidence: Evidence
) -> Exchanged:
    """The next message of a publisher that is right, or the one after the next."""
    topic = topic_of(check.endpoints["publisher"])
    inbox = context.grader_node.inbox(topic.interface, topic.name)
    asked = time.time()
    for number in range(_ON_ITS_WAY):
        clock = context.clock()
        with explained_end(context, evidence):
            came = context.wait_until(lambda number=number: len(inbox.after(asked)) > number, _SILENT_S)  # type: ignore[misc] # of one argument
        if not came:
            seconds = told(clock.fair(), _SILENT_S)
            evidence = replace(evidence, got=f"nothing on {topic.name} within {seconds} s")
            raise Failed(evidence, f"Nothing is published on {topic.name}.", "topic.silent")
        message = inbox.after(asked)[number]
        context.record.came(f"{topic.name}: {shown(plain(message))}")
        if wanted is None or next(differences(wanted, plain(message), tolerance), None) is None:
            break
    return Exchanged({}, wanted, message)


def _sends(check: Declaration) -> str:
    return next((name for name in ("request", "message") if f"{name}s" in check.keys), "")


def _plain_input(check: Declaration, case: InputCase) -> Any:
    if "service" in check.endpoints:
        return plain(made(service_of(check.endpoints["service"]).interface.Request, case.fields, "the request"))
    if "subscription" in check.endpoints:
        return plain(made(topic_of(check.endpoints["subscription"]).interface, case.fields, "the message"))
    return {}


def _named_input(check: Declaration, sent: Any) -> dict[str, Any]:
    return {_sends(check): sent} if _sends(check) else {}


def _sent(values: Mapping[str, Any], check: Declaration, case: InputCase) -> str:
    where = next((check.endpoints[end].name for end in ("service", "subscription") if end in check.endpoints), "")
    told = [shown_values(values)] if values else []
    return "; ".join([*told, f"{where}: {shown(_plain_input(check, case))}"] if where else told)

"""Declared checks of a service: it answers, and it refuses."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared import inputs
from course_kit.grading.checks.declared.around import interface_of, made
from course_kit.grading.checks.declared.explaining import Exchanged, explained
from course_kit.grading.checks.declared.messages import (
    Tolerance,
    differences,
    in_words,
    plain,
    shown,
    shown_part,
    worked_out,
)
from course_kit.grading.checks.declared.starting import ensure_up
from course_kit.grading.checks.declared.values import as_list
from course_kit.grading.checks.declared.wanted import service_of
from course_kit.grading.checks.load_test import Load, call_many
from course_kit.grading.checks.services import call

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.checks.services import Service
    from course_kit.grading.plain_data import Record
    from course_kit.ros.messages import Message

_UNANSWERED = 10  # a service keeps so many requests by default
_TOGETHER_S = 5.0  # within which many requests at a time are answered, unless the check says otherwise
_EXACT = Tolerance(0.0, 0.0)
_TO_BE_REFUSED = "a request that it has to refuse"


def answers(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each request gets the answer that is expected.

    Raises:
        Failed: one gets another, or none.
    """
    ensure_up(context, check.endpoints)
    asked = _asked(context, check, around)
    if "clients" in check.keys:  # what differs is asked at the same time, too
        asked = inputs.in_turns(asked, [inputs.count_of(one) for one in as_list(check.keys.get("requests", asked))])
    tolerance = Tolerance.of(check.keys.get("tolerance"))
    ask = _together if "clients" in check.keys else _one_by_one
    exchanges = [
        Exchanged(plain(request), wanted, response)
        for (request, wanted), response in zip(asked, ask(context, check, asked), strict=True)
    ]
    refusal = around.refusal(check.endpoints["service"].name)
    for one in exchanges:
        if next(differences(one.wanted, plain(one.got), tolerance), None) is None:
            continue
        evidence = _evidence(one, tolerance)
        _require_no_wrong_refusal(one, refusal, evidence)
        diagnosis, message = explained(one, exchanges, tolerance, floors=context.job.facts.floor_divides)
        if "clients" in check.keys and _belongs_to_another(one, exchanges, tolerance):
            diagnosis = None
            message = "This is the answer to another client's request: your callback mixes up values of two calls."
        raise Failed(evidence, message, diagnosis)
    last = _evidence(exchanges[-1], tolerance)
    if "clients" not in check.keys:
        return last
    return Evidence(_sent_together(check, asked), _expected_together(check, asked), _expected_together(check, asked))


def refuses(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each request is refused with a reason, and the node answers after it.

    Raises:
        Failed: one is accepted, refused without a reason, or the last that the node answers.
    """
    ensure_up(context, check.endpoints)
    service = service_of(check.endpoints["service"])
    refusal = check.keys.get("refused") or around.refusal(service.name)
    reason = check.keys.get("reason") or _reason_of(service.interface.Response())
    expected = " and ".join(
        filter(None, (shown_part(refusal) if refusal else "", f"a {reason} that says why" if reason else ""))
    )
    evidence = Evidence()
    for case in around.cases(check, context.job.seed):
        request = made(service.interface.Request, case.fields, "the request")
        sent = shown(plain(request))
        response = plain(call(context, service, request, sent, expected).response)
        evidence = Evidence(sent, expected, shown(response))
        if next(differences(refusal, response, _EXACT), None) is not None:
            what = in_words(check, _TO_BE_REFUSED, request=plain(request))
            raise Failed(evidence, f"Your service accepted {what}.", "validation.missing")
        if reason and not str(response[reason]).strip():
            what = in_words(check, "this", request=plain(request))
            message = f"Your service was right to refuse {what}, but its {reason} is empty: the client cannot tell why."
            raise Failed(evidence, message, "validation.no_reason")
    _require_alive(
        context, service, check.keys.get("valid") or around.valid_request(service.name, context.job.seed), refusal
    )
    return evidence


def _require_alive(context: CheckContext, service: Service, valid: Record | None, refusal: Record) -> None:
    """After a refusal the node answers a valid request; without a known one its answers have shown that it lives."""
    if valid is None:
        return
    request = made(service.interface.Request, valid, "the request")
    sent, expected = shown(plain(request)), "an answer: the node is still running, and this request is valid"
    response = plain(call(context, service, request, sent, expected).response)
    if refusal and next(differences(refusal, response, _EXACT), None) is None:
        raise Failed(Evidence(sent, expected, shown(response)), _OVERZEALOUS, "validation.overzealous")


_OVERZEALOUS = "Your service refused a valid request."


def _asked(context: CheckContext, check: Declaration, around: Around) -> list[tuple[Message, Any]]:
    """The requests, each with what is wanted for it."""
    interface = interface_of(check.endpoints["service"].type)
    found = []
    for number, case in enumerate(around.cases(check, context.job.seed)):
        request = made(interface.Request, case.fields, "the request")
        names = {"request": plain(request), **around.oracle(check, number)}
        found.append((request, worked_out(case.expected, names)))
    return found


def _one_by_one(context: CheckContext, check: Declaration, asked: Sequence[tuple[Message, Any]]) -> list[Message]:
    service, within_s = service_of(check.endpoints["service"]), check.keys.get("within_s")
    responses = []
    for request, wanted in asked:
        sent, expected = shown(plain(request)), shown_part(wanted)
        began = time.monotonic()
        answer = call(context, service, request, sent, expected)
        require_not_before(check, time.monotonic() - began, Evidence(sent, expected))
        if within_s is not None and answer.latency_s > within_s:
            evidence = Evidence(sent, f"{expected} within {within_s:g} s", f"an answer after {answer.latency_s:.1f} s")
            message = f"The answer took {answer.latency_s:.1f} s, and meanwhile every other client has to wait."
            raise Failed(evidence, message, "service.blocks")
        responses.append(answer.response)
    return responses


def require_not_before(check: Declaration, seconds: float, evidence: Evidence) -> None:
    """What takes its time took it: it was not left out to be quicker.

    Args:
        check: may say how long it takes at least.
        seconds: how long it took on the wall; a clock that leaves out waiting might show less.
        evidence: what was asked, and what is expected.

    Raises:
        Failed: it came sooner.
    """
    least = check.keys.get("not_before_s", 0.0)
    if seconds < least:
        got = f"it came after {seconds:.2f} s"
        evidence = Evidence(evidence.sent, f"{evidence.expected}, not before {least:g} s have passed", got)
        raise Failed(evidence, "This came too soon: the work that takes so long was not done.")


def _together(context: CheckContext, check: Declaration, asked: Sequence[tuple[Message, Any]]) -> list[Message]:
    service = service_of(check.endpoints["service"])
    evidence = Evidence(_sent_together(check, asked), _expected_together(check, asked))
    return call_many(context, service, [request for request, _ in asked], _load(check), evidence)


def _load(check: Declaration) -> Load:
    clients = int(check.keys["clients"])
    return Load(clients, min(clients, _UNANSWERED), float(check.keys.get("within_s", _TOGETHER_S)))


def _sent_together(check: Declaration, asked: Sequence[object]) -> str:
    load = _load(check)
    return f"{len(asked)} requests from {load.clients} clients, at most {load.unanswered} unanswered at a time"


def _expected_together(check: Declaration, asked: Sequence[object]) -> str:
    return f"{len(asked)} answers within {_load(check).seconds:g} s, each to its own request"


def _evidence(one: Exchanged, tolerance: Tolerance) -> Evidence:
    exact = tolerance.wants_all_digits
    told = shown(plain(one.got), exact=exact)
    return Evidence(shown(one.sent, exact=exact), shown_part(one.wanted, exact=exact), told)


def _require_no_wrong_refusal(one: Exchanged, refusal: Record, evidence: Evidence) -> None:
    """A valid request was not refused, and one that is to be refused was not accepted."""
    if not refusal or not isinstance(one.wanted, dict) or not set(refusal) <= set(one.wanted):
        return
    refused = next(differences(refusal, plain(one.got), _EXACT), None) is None
    to_be_refused = next(differences(refusal, one.wanted, _EXACT), None) is None
    if refused and not to_be_refused:
        raise Failed(evidence, _OVERZEALOUS, "validation.overzealous")
    if to_be_refused and not refused:
        raise Failed(evidence, f"Your service accepted {_TO_BE_REFUSED}.", "validation.missing")


def _belongs_to_another(wrong: Exchanged, of_all: Sequence[Exchanged], tolerance: Tolerance) -> bool:
    got = plain(wrong.got)
    return any(next(differences(one.wanted, got, tolerance), None) is None for one in of_all if one is not wrong)


def _reason_of(response: Message) -> str:
    """The field that tells a reason: the only text of a response."""
    texts = [name for name, kind in response.get_fields_and_field_types().items() if kind == "string"]
    return texts[0] if len(texts) == 1 else ""


def ask(context: CheckContext, check: Declaration, around: Around) -> list[Any]:
    """What the solution, which runs now, answers to the requests of a check."""
    service = service_of(check.endpoints["service"])
    found = []
    for case in around.cases(check, context.job.seed):
        request = made(service.interface.Request, case.fields, "the request")
        found.append(
            plain(call(context, service, request, shown(plain(request)), "an answer of the solution").response)
        )
    return found

"""Declared checks of parameters: what is declared, and what is refused. What one acts on is in `acting`."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.check import Evidence, Failed
from course_kit.grading.checks.declared.inputs import drawn
from course_kit.grading.checks.declared.rules import type_of, wanted_of
from course_kit.grading.checks.declared.settings import put_back, served
from course_kit.grading.checks.declared.values import as_list
from course_kit.grading.checks.parameters import require_proper_answer, shown
from course_kit.ros.parameters import NOT_SET

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.grading.checks.context import CheckContext
    from course_kit.grading.checks.declared.around import Around
    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.checks.parameters import Remote, SetResult, Value

_NEEDS_A_POINT = " A double needs a decimal point."


def parameter_declared(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """The parameters are there, with their types and their defaults.

    Raises:
        Failed: one is not, or has others.
    """
    del around
    wanted = wanted_of(check.keys)
    remote = served(context, check.node)
    if not any(kind for kind, _ in wanted.values()):
        return _require_names(remote, list(wanted), Evidence("list_parameters", ", ".join(wanted)))
    found = remote.values(list(wanted))
    told = ", ".join(f"{name}={one.value!r}, of type {one.type}" for name, one in found.items())
    evidence = Evidence("get_parameters", ", ".join(itertools.starmap(_shown_wanted, wanted.items())), told)
    if empty := [name for name, one in found.items() if one.type == NOT_SET]:
        _require_names(remote, empty, evidence)
        message = f"{_are(empty)} declared without a value, so there is nothing to read."
        raise Failed(evidence, message, "parameter.default")
    if wrong := [name for name, (kind, _) in wanted.items() if kind and found[name].type != kind]:
        told = " and ".join(f"{name} is {found[name].type}, expected {wanted[name][0]}" for name in wrong)
        point = any((found[name].type, wanted[name][0]) == ("integer", "double") for name in wrong)
        raise Failed(evidence, f"{told}.{_NEEDS_A_POINT if point else ''}", "parameter.type")
    others = {
        name: found[name].value
        for name, (_, default) in wanted.items()
        if default is not None and found[name].value != default
    }
    if others:
        raise Failed(evidence, f"Started without settings, your node has {shown(others)}.", "parameter.default")
    return evidence


def _require_names(remote: Remote, wanted: Sequence[str], evidence: Evidence) -> Evidence:
    """These parameters are declared, with a value or without one."""
    names = remote.names()
    if missing := [name for name in wanted if name not in names]:
        evidence = replace(evidence, got=f"the node has {', '.join(names) or 'no parameters'}")
        raise Failed(evidence, f"Your node has not declared {', '.join(missing)}.", "parameter.undeclared")
    return replace(evidence, got=evidence.got or ", ".join(names))


def _shown_wanted(name: str, wanted: tuple[str, Any]) -> str:
    kind, default = wanted
    return f"{name}{f' of type {kind}' if kind else ''}{'' if default is None else f', {default!r} at the start'}"


def _are(names: Sequence[str]) -> str:
    return f"{' and '.join(names)} {'is' if len(names) == 1 else 'are'}"


def parameter_refuses(context: CheckContext, check: Declaration, around: Around) -> Evidence:
    """Each change is refused with a reason, and the values stay what they were.

    Raises:
        Failed: one is accepted, refused without a reason, or changes a value all the same.
    """
    del around
    evidence = Evidence()
    for values in drawn(as_list(check.keys["set"]), context.job.seed, check.id):
        remote = served(context, check.node)
        with put_back(context, remote, values) as before:
            evidence = _refused(check, remote, values, before)
            now = remote.values(list(values))
            if now != before:
                changed = {name: one.value for name, one in now.items() if one != before[name]}
                evidence = replace(evidence, got=f"refused, but now {shown(changed)}")
                message = "The parameter has changed although the change was refused."
                raise Failed(evidence, message, "parameter.not_atomic")
    return evidence


def _refused(check: Declaration, remote: Remote, values: Mapping[str, Any], before: Mapping[str, Value]) -> Evidence:
    """Try to set values, each by itself or all together, and have that refused."""
    attempts = [values] if check.keys.get("together") else [{name: value} for name, value in values.items()]
    evidence = Evidence()
    for attempt in attempts:
        code = _code_of(attempt, before)
        needs_reason = code == "validation.missing"
        words = check.keys.get("reason", ())
        told = f", with a reason{' that names ' + ' and '.join(words) if words else ''}" if needs_reason else ""
        outcome = (
            remote.set_together(attempt) if check.keys.get("together") else remote.set(*next(iter(attempt.items())))
        )
        evidence = Evidence(shown(attempt), f"refused{told}", outcome.shown())
        if outcome.successful:
            raise Failed(evidence, f"Your node accepted {shown(attempt)}.", code)
        require_proper_answer(outcome, evidence)
        if needs_reason:
            _require_reason(outcome, words, evidence)
    return evidence


def _code_of(attempt: Mapping[str, Any], before: Mapping[str, Value]) -> str:
    """What it means when an attempt is accepted: of values of the right types, that nobody looked at them."""
    types = [before[name].type for name in attempt]
    if NOT_SET in types:
        return "parameter.undeclared"
    wrong = [name for name, value in attempt.items() if type_of(value) not in ("", before[name].type)]
    return "parameter.type" if wrong else "validation.missing"


def _require_reason(outcome: SetResult, words: tuple[str, ...], evidence: Evidence) -> None:
    """Whoever tried learns why it was refused."""
    reason = outcome.reason
    lacks = [word for word in words if word not in reason]
    if reason.strip() and not lacks:
        return
    told = f"It does not name {' and '.join(lacks)}." if reason.strip() else "It is empty."
    message = f"Your node was right to refuse, but the reason has to say why. {told}"
    raise Failed(evidence, message, "validation.no_reason")

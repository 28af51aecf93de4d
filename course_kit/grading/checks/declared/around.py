"""What a declared check knows of the exercise around it: its inputs, the other checks, what the solution answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit.grading.checks.declared import inputs
from course_kit.grading.checks.declared.definitions import fields_of
from course_kit.grading.checks.declared.kinds import ORACLE, kind_of
from course_kit.grading.checks.declared.values import as_list
from course_kit.interfaces import get_type
from course_kit.ros.filling import fill_from_yaml

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.grading.checks.declared.declaration import Declaration
    from course_kit.grading.plain_data import Record
    from course_kit.ros.messages import Message

_SUCCESS = "success"  # the field of many responses that says whether a request was refused


class InputCase(NamedTuple):
    """One input of a check, its values drawn, and what is expected for it, as it is written."""

    fields: Record
    expected: Any


@dataclass
class Around:
    """The exercise.

    Attributes:
        declarations: all its declared checks.
        answers: what the solution has answered to the inputs of checks, as plain data, by the checks' ids.
    """

    declarations: Sequence[Declaration]
    answers: dict[str, list[Any]] = field(default_factory=dict)

    def cases(self, check: Declaration, seed: int) -> list[InputCase]:
        """The inputs of a check, which are always the same for a seed."""
        kind = kind_of({"kind": check.kind, **check.keys})
        if "cases" in check.keys:
            filled = inputs.drawn([case[kind.sends] for case in check.keys["cases"]], seed, check.id)
            return [InputCase(one, case["expect"]) for one, case in zip(filled, check.keys["cases"], strict=True)]
        tables = as_list(check.keys[kind.inputs])
        return [InputCase(one, check.keys.get("expect")) for one in inputs.drawn(tables, seed, check.id)]

    def oracle(self, check: Declaration, number: int) -> Mapping[str, Any]:
        """The name for what the solution has answered to an input, where it was asked."""
        found = self.answers.get(check.id)
        return {ORACLE: found[number]} if found is not None else {}

    def refusal(self, service: str) -> Record:
        """The fields by which a response of this service says no; empty where nothing tells."""
        for one in self.declarations:
            if one.kind == "refuses" and one.endpoints["service"].name == service and "refused" in one.keys:
                return dict(one.keys["refused"])
        endpoints = (one for check in self.declarations for one in check.endpoints.values())
        kind = next(one.type for one in endpoints if one.kind == "service" and one.name == service)
        success = fields_of(kind)["response"].types.get(_SUCCESS)
        return {_SUCCESS: False} if success is not None and success.base == "boolean" else {}

    def valid_request(self, service: str, seed: int) -> Record | None:
        """A request to this service that has to be answered; None when no check names one."""
        for one in self.declarations:
            if one.kind == "answers" and one.endpoints["service"].name == service:
                return self.cases(one, seed)[0].fields
        return None


def made(message_type: Any, fields: Record, what: str) -> Message:
    """A message with these fields, as an author has written them.

    Args:
        message_type: its class.
        fields: by their names.
        what: how to call it in errors.
    """
    message = message_type()
    fill_from_yaml(message, fields, what)
    return message


def interface_of(type_name: str) -> Any:
    """The class of an interface."""
    return get_type(type_name)

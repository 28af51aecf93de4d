"""Reads the `[[endpoints]]` of an exercise.toml: what the node offers, and what it publishes and subscribes to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.grading.checks.declared.declaration import WantedEndpoint
from course_kit.grading.checks.declared.definitions import PARTS, Fields, UnknownInterfaceError, fields_of
from course_kit.ros.names import from_root, nearest

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.checks.declared.lines import Lines
    from course_kit.grading.checks.declared.mistakes import MistakeList
    from course_kit.grading.plain_data import Record

ENDPOINTS = "endpoints"
INTERFACES = {"service": "srv", "action": "action", "publisher": "msg", "subscription": "msg"}
_OF_ENDPOINT = ("kind", "name", "type")
AN_ENDPOINT = (
    'An endpoint is, for example, {kind = "service", name = "/add", type = "example_interfaces/srv/AddTwoInts"}.'
)


def endpoints_of(tables: list[Record], lines: Lines, mistakes: MistakeList) -> list[WantedEndpoint]:
    """The `[[endpoints]]` of an exercise; those with mistakes are left out.

    Args:
        tables: as they are written.
        lines: where they stand.
        mistakes: gets what is wrong.
    """
    found = []
    for number, one in enumerate(tables):
        texts = {key: one.get(key) for key in _OF_ENDPOINT}
        if not all(isinstance(text, str) and text for text in texts.values()):
            mistakes.add(lines.of_table(ENDPOINTS, number), f"It lacks a key. {AN_ENDPOINT}")
            continue
        endpoint = WantedEndpoint(str(one["kind"]), from_root(str(one["name"])), str(one["type"]))
        if problem := _problem_of(endpoint):
            word = "kind" if endpoint.kind not in INTERFACES else "type"
            mistakes.add(lines.within(ENDPOINTS, number, word), problem)
        else:
            found.append(endpoint)
    return found


def _problem_of(endpoint: WantedEndpoint) -> str:
    if endpoint.kind not in INTERFACES:
        return f"There is no kind of endpoint '{endpoint.kind}'.{choice(endpoint.kind, INTERFACES)}"
    wanted, parts = INTERFACES[endpoint.kind], endpoint.type.split("/")
    if len(parts) != 3 or parts[1] != wanted:  # noqa: PLR2004 - package, kind and name
        return f"The type of a {endpoint.kind} is 'package/{wanted}/Name', not '{endpoint.type}'."
    try:
        fields_of(endpoint.type)
    except UnknownInterfaceError as problem:
        return str(problem)
    except ImportError:  # no ROS here to read definitions with: whoever grades meets it again
        return ""
    return ""


def choice(wrong: str, known: Mapping[str, Any]) -> str:
    """The nearest of some names, or all of them; with a space before it."""
    near = nearest(wrong, known)
    return f" Did you mean '{near}'?" if near else f" There are {', '.join(known)}."


def part_of(part: str, key: str, endpoints: Mapping[str, WantedEndpoint]) -> Fields | None:
    """The fields of a part of the interface that a key is about; None where they cannot be known."""
    sent = key in ("messages", "message", "set")
    for name, endpoint in endpoints.items():
        if part in PARTS[INTERFACES[endpoint.kind]] and not (
            part == "message" and name != ("subscription" if sent else "publisher") and len(endpoints) > 1
        ):
            try:
                return fields_of(endpoint.type)[part]
            except (UnknownInterfaceError, ImportError):
                return None
    return None

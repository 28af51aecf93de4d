"""Finds the interface a learner names on the command line."""

from __future__ import annotations

import re
from functools import reduce
from typing import Any

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError

LOOK_S = 5.0  # for the graph to settle
# What actions and services send under the hood has types of its own, and no definition file of its own.
_INNER = re.compile(r"(?P<outer>\w+/(?:srv|action)/[A-Za-z0-9]+)_(?P<part>\w+)")
_PARTS = {
    "Event": ("Event",),
    "FeedbackMessage": ("Impl", "FeedbackMessage"),
    "SendGoal_Event": ("Impl", "SendGoalService", "Event"),
    "GetResult_Event": ("Impl", "GetResultService", "Event"),
}
_WORDS = {"msg": "message", "srv": "service", "action": "action"}
_ARTICLES = {"msg": "a message", "srv": "a service", "action": "an action"}


def find_type(name: str, kind: str) -> Any:
    """The class for `pkg/Name` or `pkg/kind/Name`."""
    from course_kit import interfaces

    inner = _INNER.fullmatch(name) if kind == "msg" else None
    if inner and inner["part"] in _PARTS:
        outer = find_type(inner["outer"], inner["outer"].split("/")[1])
        return reduce(getattr, _PARTS[inner["part"]], outer)
    parts = name.split("/")
    wanted = f"{parts[0]}/{kind}/{parts[1]}" if len(parts) == 2 else name  # noqa: PLR2004 - package and name
    try:
        interface = interfaces.get_type(wanted)
    except (LookupError, ValueError) as problem:
        text = f"The passed {_WORDS[kind]} type is invalid: "
        if isinstance(problem, ValueError):
            raise CommandError(f"{text}{problem}") from problem
        near = did_you_mean(wanted, interfaces.types(kind=kind))
        raise CommandError(f"{text}there is no {wanted}.{near}") from problem
    if f"/{kind}/" not in wanted:
        raise CommandError(f"The passed {_WORDS[kind]} type is invalid: {wanted} is not {_ARTICLES[kind]} type.")
    return interface

"""TypedValues typed as YAML put into a message."""

from __future__ import annotations

import re
import sys
from functools import reduce
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.session import CommandError

if TYPE_CHECKING:
    from argparse import Namespace

    from course_kit.ros.messages import Message

LOOK_S = 5.0  # for the graph to settle
# Actions and services send hidden types, which have no definition file.
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


_OF_THE_MOMENT = ("now", "auto")  # what a time and a header may be given as


class TypedValues:
    """TypedValues for the fields of a message."""

    def __init__(self, text: str | None, owner: str) -> None:
        self._text, self._owner = text, owner
        self._values = _load(text)

    @property
    def are_of_the_moment(self) -> bool:
        """Whether they hold a time that differs each time they are put into a message."""
        return _holds(self._values, _OF_THE_MOMENT)

    def put_into(self, message: Message) -> None:
        """Set the fields that are named."""
        from course_kit.ros.filling import fill_from_yaml
        from course_kit.ros.messages import BadFieldError

        if not isinstance(self._values, dict):
            known = ", ".join(f"{name}: ..." for name in message.get_fields_and_field_types())
            raise CommandError(f"{self._owner} takes its fields as '{{{known}}}', not {self._text!r}.")
        try:
            fill_from_yaml(message, self._values, self._owner)
        except BadFieldError as error:
            raise CommandError(str(error)) from error


def fill_message(message: Message, text: str | None, owner: str) -> None:
    """Set the fields of a message from YAML text such as '{a: 1, b: 2}'."""
    TypedValues(text, owner).put_into(message)


def read_typed(options: Namespace, name: str) -> str | None:
    """What was typed as the values, or comes from standard input with `--stdin`."""
    text: str | None = sys.stdin.read() if options.stdin else getattr(options, name)
    return text


def _holds(value: object, words: tuple[str, ...]) -> bool:
    if isinstance(value, dict):
        return any(_holds(inner, words) for inner in value.values())
    if isinstance(value, list):
        return any(_holds(inner, words) for inner in value)
    return isinstance(value, str) and value in words


def _load(text: str | None) -> object:
    import yaml

    try:
        loaded = yaml.safe_load(text) if text else {}
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f" in line {mark.line + 1}, column {mark.column + 1}" if mark else ""
        raise CommandError(f"The values are not valid YAML: {error.problem}{place} of {text!r}.") from error
    except yaml.YAMLError as error:
        raise CommandError(f"The values are not valid YAML: {error}") from error
    return {} if loaded is None else loaded

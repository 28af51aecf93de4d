"""Values typed as YAML put into a message."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros2cli.errors import CommandError

if TYPE_CHECKING:
    from course_kit.ros.messages import Message


def _load(text: str | None) -> object:
    """The YAML in `text`; an empty mapping for nothing.

    Raises:
        CommandError: it is no YAML; says where in one line.
    """
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


def fill(message: Message, text: str | None, owner: str) -> None:
    """Set the fields of a message from YAML text such as '{a: 1, b: 2}'.

    Args:
        message: the message; fields that are not named keep their defaults.
        text: the YAML.
        owner: the message's ROS name, for errors.

    Raises:
        CommandError: no YAML, an unknown field, a value that does not fit; the field is named.
    """
    from course_kit.ros.errors import BadFieldError
    from course_kit.ros.filling import fill_from_yaml

    values = _load(text)
    if not isinstance(values, dict):
        known = ", ".join(f"{name}: ..." for name in message.get_fields_and_field_types())
        raise CommandError(f"{owner} takes its fields as '{{{known}}}', not {text!r}.")
    try:
        fill_from_yaml(message, values, owner)
    except BadFieldError as error:
        raise CommandError(str(error)) from error

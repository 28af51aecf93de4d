"""Requests, goals and messages out of what a caller has passed: a ready one, or its fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.lab.errors import FieldError
from course_kit.ros.errors import BadFieldError
from course_kit.ros.filling import make
from course_kit.ros.messages import is_message_type

if TYPE_CHECKING:
    from course_kit.ros.filling import Fields
    from course_kit.ros.messages import Message


def require_message_type(given: object) -> None:
    """Refuse what is not a message's class.

    Raises:
        FieldError: it is none.
    """
    if not is_message_type(given):
        raise FieldError(f"{getattr(given, '__name__', given)!r} is not a message type.")


def message_of(message_type: type[Message], ready: Message, fields: Fields, owner: str) -> Message:
    """The message to be sent.

    Args:
        message_type: its class.
        ready: a ready one, or None.
        fields: its fields, where there is no ready one.
        owner: how to call it in errors, e.g. "a std_srvs/srv/Trigger request".

    Raises:
        FieldError: both are given, there is no such field, or it cannot take the value.
    """
    if ready is None:
        try:
            return make(message_type, fields, owner)
        except BadFieldError as error:
            raise FieldError(str(error)) from error
    if fields or not isinstance(ready, message_type):
        raise FieldError(f"Pass either {owner} or its fields as keywords.")
    return ready

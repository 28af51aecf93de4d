"""Requests, goals and messages out of what a caller has passed: a ready one, or its fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.lab.errors import FieldError
from course_kit.ros.filling import make_message
from course_kit.ros.messages import BadFieldError, is_message_type

if TYPE_CHECKING:
    from course_kit.ros.filling import Fields
    from course_kit.ros.messages import Message


def require_message_type(given: object) -> None:
    """Refuse what is not a message's class."""
    if not is_message_type(given):
        raise FieldError(f"{getattr(given, '__name__', given)!r} is not a message type.")


def message_of(message_type: type[Message], ready: Message, fields: Fields, owner: str) -> Message:
    """The message to be sent."""
    if ready is None:
        try:
            return make_message(message_type, fields, owner)
        except BadFieldError as error:
            raise FieldError(str(error)) from error
    if fields or not isinstance(ready, message_type):
        raise FieldError(f"Pass either {owner} or its fields as keywords.")
    return ready

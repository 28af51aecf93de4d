"""Interfaces in ROS's words: names of classes and of the types of fields."""

from __future__ import annotations

from typing import Any, TypeAlias

# An object of a generated class: a message, a request, a goal; and the classes themselves. Their fields and parts are
# those of their definition, which is read while the program runs: a type checker cannot know them.
Message: TypeAlias = Any
MessageType: TypeAlias = Any
ServiceType: TypeAlias = Any
ActionType: TypeAlias = Any


class BadFieldError(ValueError):
    """A field was given by a wrong name, or it or a parameter with a value it cannot take; the message says which."""


# As `get_fields_and_field_types` has them, and as a definition spells them.
_WORDS = {"boolean": "bool", "double": "float64", "float": "float32", "octet": "byte"}


def type_name(interface: Any) -> str:
    """The ROS name of an interface class, e.g. "std_srvs/srv/Trigger"."""
    module = str(getattr(interface, "__module__", "")).split(".")
    return "/".join([*module[:2], interface.__name__]) if len(module) > 1 else str(interface.__name__)


def describe_type(message_type: MessageType) -> str:
    """A class of messages in a sentence, e.g. "a std_msgs/msg/String", "a std_srvs/srv/Trigger request"."""
    name = type_name(message_type)
    if name.endswith("_Request"):
        return f"a {name.removesuffix('_Request')} request"
    return f"a goal of {name.removesuffix('_Goal')}" if name.endswith("_Goal") else f"a {name}"


def is_message_type(interface: object) -> bool:
    """Whether this is a message's class."""
    return isinstance(interface, type) and hasattr(interface, "get_fields_and_field_types")


def ros_word(field_type: str) -> str:
    """The type of a field as a definition spells it, such as "float64" for "double"."""
    return _WORDS.get(field_type, field_type)


def with_article(word: str) -> str:
    """A word as "an int" or "a float"."""
    return f"{'an' if word[0] in 'aeio' else 'a'} {word}"

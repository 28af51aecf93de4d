"""Gives a live class its type support: the C side, made when rclpy first asks for it."""

# ruff: noqa: SLF001 - the attributes of metaclasses are what rosidl_generator_py and rclpy agreed on

from __future__ import annotations

import struct
import threading
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.message_fields import record_of
from course_kit.interfaces.native.helper import Helper
from course_kit.interfaces.native.loader import capsule, pointer

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.codec.encoder import Encode, Payload
    from course_kit.interfaces.message_fields import LiveRecord, LiveType, Message

# Two threads may use a type for the first time at once; what is made for it must be made once.
_making = threading.RLock()
# rosidl_service_introspection_info_t: event type, seconds, nanoseconds, client's id, sequence number.
_EVENT_INFO = struct.Struct("B3xiI16s4xq")


@lru_cache(maxsize=1)
def _helper() -> Helper:
    return Helper()


def add_support(cls: Any) -> None:
    """Fill in what rclpy looks for on the metaclass of a live message, service or action, and of all its parts."""
    with _making:
        if type(cls)._TYPE_SUPPORT is not None:
            return
        if hasattr(cls, "Impl"):
            support = _action_support(cls)
        elif hasattr(cls, "Request"):
            parts = [_support_address(part) for part in (cls.Request, cls.Response, cls.Event)]
            support = _helper().service(cls, parts, _live_type(cls.Event), _event_maker(cls))
        else:
            support = _message_support(cls)
        type(cls)._TYPE_SUPPORT = capsule(support)  # last: with it rclpy takes the rest as given


def _message_support(cls: Any) -> int:
    metaclass, made = type(cls), _helper().message(cls, _support_address)
    metaclass._CREATE_ROS_MESSAGE = capsule(made.create)
    metaclass._DESTROY_ROS_MESSAGE = capsule(made.destroy)
    metaclass._CONVERT_FROM_PY = capsule(made.from_python)
    metaclass._CONVERT_TO_PY = capsule(made.to_python)
    _record(cls).native = made.type
    return made.support


def _action_support(cls: Any) -> int:
    for part in (cls.Goal, cls.Result, cls.Feedback):
        add_support(part)
    names = ("SendGoalService", "GetResultService", "CancelGoalService", "FeedbackMessage", "GoalStatusMessage")
    return _helper().action(cls, [_support_address(getattr(cls.Impl, name)) for name in names])


def _live_type(cls: type) -> LiveType:
    """The native helper's record of a live message whose type support has been made."""
    native = _record(cls).native
    assert native is not None  # noqa: S101 - see above
    return native


def _record(cls: type) -> LiveRecord:
    record = record_of(cls)
    assert record is not None  # noqa: S101 - only live classes come here
    return record


def _support_address(cls: Any) -> int:
    """The address of the type support of a live or compiled class."""
    metaclass = type(cls)
    if metaclass._TYPE_SUPPORT is None:
        metaclass.__import_type_support__()
    return pointer(metaclass._TYPE_SUPPORT)


def _event_maker(cls: Any) -> Callable[[bytes, bytes | None, bytes | None], Payload]:
    """Make the function that builds the message service introspection publishes, out of payloads."""
    from course_kit.interfaces.codec import make_decoder, make_encoder

    @lru_cache(maxsize=1)
    def codecs() -> tuple[Encode, Callable[[bytes], Message], Callable[[bytes], Message]]:
        return make_encoder(cls.Event), make_decoder(cls.Request), make_decoder(cls.Response)

    def make_event(info: bytes, request: bytes | None, response: bytes | None) -> Payload:
        encode, decode_request, decode_response = codecs()
        event = cls.Event()
        kind, seconds, nanoseconds, client, sequence_number = _EVENT_INFO.unpack(info)
        event.info.event_type, event.info.sequence_number = kind, sequence_number
        event.info.stamp.sec, event.info.stamp.nanosec = seconds, nanoseconds
        event.info.client_gid = list(client)
        event.request = [] if request is None else [decode_request(request)]
        event.response = [] if response is None else [decode_response(response)]
        return encode(event)

    return make_event

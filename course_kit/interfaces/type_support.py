"""Gives a live class its type support: the C side, made when rclpy first asks for it."""

# ruff: noqa: SLF001 - the attributes of metaclasses are what rosidl_generator_py and rclpy agreed on

from __future__ import annotations

import struct
import threading
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.live_record import record_of
from course_kit.interfaces.native.helper import Helper
from course_kit.interfaces.native.memory import capsule, pointer

if TYPE_CHECKING:
    from collections.abc import Callable

# Two threads may use a type for the first time at once; what is made for it must be made once.
_making = threading.RLock()
# rosidl_service_introspection_info_t: event type, seconds, nanoseconds, client's id, sequence number.
_EVENT_INFO = struct.Struct("B3xiI16s4xq")


@lru_cache(maxsize=1)
def _helper() -> Helper:
    return Helper()


def add_message_support(cls: Any) -> None:
    """Fill in what rclpy looks for on a message's metaclass.

    Raises:
        NativeHelperError: the native helper cannot be used here.
    """
    metaclass, record = type(cls), record_of(cls)
    with _making:
        if metaclass._TYPE_SUPPORT is not None or record is None:
            return
        made = _helper().message(cls, _support_address)
        metaclass._CREATE_ROS_MESSAGE = capsule(made.create)
        metaclass._DESTROY_ROS_MESSAGE = capsule(made.destroy)
        metaclass._CONVERT_FROM_PY = capsule(made.from_python)
        metaclass._CONVERT_TO_PY = capsule(made.to_python)
        record.native = made.type
        metaclass._TYPE_SUPPORT = capsule(made.support)  # last: with it rclpy takes the rest as given


def add_service_support(cls: Any) -> None:
    """Fill in what rclpy looks for on a service's metaclass, its three messages included."""
    metaclass = type(cls)
    with _making:
        if metaclass._TYPE_SUPPORT is not None:
            return
        parts = [_support_address(part) for part in (cls.Request, cls.Response, cls.Event)]
        support = _helper().service(cls, parts, native_type(cls.Event), _event_maker(cls))
        metaclass._TYPE_SUPPORT = capsule(support)


def add_action_support(cls: Any) -> None:
    """Fill in what rclpy looks for on an action's metaclass and on all its parts."""
    metaclass = type(cls)
    with _making:
        if metaclass._TYPE_SUPPORT is not None:
            return
        for part in (cls.Goal, cls.Result, cls.Feedback):
            add_message_support(part)
        names = ("SendGoalService", "GetResultService", "CancelGoalService", "FeedbackMessage", "GoalStatusMessage")
        parts = [_support_address(getattr(cls.Impl, name)) for name in names]
        metaclass._TYPE_SUPPORT = capsule(_helper().action(cls, parts))


def native_type(cls: Any) -> Any:
    """The native helper's record of a live message whose type support has been made."""
    record = record_of(cls)
    return None if record is None else record.native


def _support_address(cls: Any) -> int:
    """The address of the type support of a live or compiled class."""
    metaclass = type(cls)
    if metaclass._TYPE_SUPPORT is None:
        metaclass.__import_type_support__()
    return pointer(metaclass._TYPE_SUPPORT)


def _event_maker(cls: Any) -> Callable[[bytes, bytes | None, bytes | None], bytes]:
    """Make the function that builds the message service introspection publishes, out of payloads."""
    from course_kit.interfaces.codec import make_decoder, make_encoder

    @lru_cache(maxsize=1)
    def codecs() -> tuple[Any, Any, Any]:
        return make_encoder(cls.Event), make_decoder(cls.Request), make_decoder(cls.Response)

    def make_event(info: bytes, request: bytes | None, response: bytes | None) -> bytes:
        encode, decode_request, decode_response = codecs()
        event = cls.Event()
        kind, seconds, nanoseconds, client, sequence_number = _EVENT_INFO.unpack(info)
        event.info.event_type, event.info.sequence_number = kind, sequence_number
        event.info.stamp.sec, event.info.stamp.nanosec = seconds, nanoseconds
        event.info.client_gid = list(client)
        event.request = [] if request is None else [decode_request(request)]
        event.response = [] if response is None else [decode_response(response)]
        encoded: bytes = encode(event)
        return encoded

    return make_event

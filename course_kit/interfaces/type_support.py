"""Gives a live class its type support: the C side, made when rclpy first asks for it."""

# ruff: noqa: SLF001 - the attributes of metaclasses are what rosidl_generator_py and rclpy agreed on

from __future__ import annotations

import array
import ctypes
import struct
import threading
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

from course_kit.interfaces.codec.encoder import make_decoder, make_encoder
from course_kit.interfaces.definition import EMPTY_MEMBER, FieldType
from course_kit.interfaces.errors import NativeHelperError
from course_kit.interfaces.message_fields import MessageField, message_fields
from course_kit.interfaces.native import loader
from course_kit.interfaces.native.loader import function_address, keep_data, keep_object, keep_text, make_capsule
from course_kit.interfaces.type_description import describe_type, full_name, referenced_classes, source_text, type_hash

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.codec.encoder import Encode, Payload
    from course_kit.interfaces.message_fields import Message
    from course_kit.interfaces.type_description import DescribedField

# Two threads may use a type for the first time at once; what is made for it must be made once.
_making = threading.RLock()
# rosidl_service_introspection_info_t: event type, seconds, nanoseconds, client's id, sequence number.
_EVENT_INFO = struct.Struct("B3xiI16s4xq")
_INTROSPECTION_STRING, _INTROSPECTION_WSTRING, _INTROSPECTION_MESSAGE = 16, 17, 18
_HASH_VERSION = 1
_NO_FIELDS = (MessageField(EMPTY_MEMBER, FieldType("uint8"), None),)


@lru_cache(maxsize=1)
def _helper() -> ctypes.PyDLL:
    return loader.load_helper()


def add_support(cls: Any) -> None:
    """Fill in what rclpy looks for on the metaclass of a live message, service or action, and of all its parts."""
    with _making:
        if type(cls)._TYPE_SUPPORT is not None:
            return
        if hasattr(cls, "Impl"):
            support = _action_support(cls)
        elif hasattr(cls, "Request"):
            support = _service_support(cls)
        else:
            support = _message_support(cls)
        type(cls)._TYPE_SUPPORT = make_capsule(support)  # last: with it rclpy takes the rest as given


def _message_support(cls: Any) -> int:
    helper, metaclass = _helper(), type(cls)
    package, folder, name = full_name(cls).split("/")
    description = description_of(cls)
    address = metaclass._live.native = _new_type(cls)
    metaclass._CREATE_ROS_MESSAGE = make_capsule(helper.live_create_function(address))
    metaclass._DESTROY_ROS_MESSAGE = make_capsule(function_address(helper.live_destroy))
    metaclass._CONVERT_FROM_PY = make_capsule(function_address(helper.live_from_python))
    metaclass._CONVERT_TO_PY = make_capsule(function_address(helper.live_to_python))
    library = loader.ros_library("librosidl_typesupport_introspection_c.so")
    introspection = helper.live_introspection(
        # rmw_fastrtps compares this one by its address.
        ctypes.c_void_p.in_dll(library, "rosidl_typesupport_introspection_c__identifier").value,
        keep_text(f"{package}__{folder}"),
        keep_text(name),
        *_members(message_fields(cls) or _NO_FIELDS),
        description,
    )
    support: int = helper.live_message_support(
        keep_text(f"{package}::{folder}"), keep_text(name), description, introspection
    )
    return support


def _service_support(cls: Any) -> int:
    package, folder, name = full_name(cls).split("/")
    parts = [_support_address(part) for part in (cls.Request, cls.Response, cls.Event)]
    make_event = _event_maker(cls)
    keep_object(make_event)
    event = type(cls.Event)._live.native
    support: int = _helper().live_service_support(
        keep_text(f"{package}::{folder}"), keep_text(name), *parts, event, make_event, description_of(cls)
    )
    return support


def _action_support(cls: Any) -> int:
    for part in (cls.Goal, cls.Result, cls.Feedback):
        add_support(part)
    names = ("SendGoalService", "GetResultService", "CancelGoalService", "FeedbackMessage", "GoalStatusMessage")
    parts = [_support_address(getattr(cls.Impl, name)) for name in names]
    support: int = _helper().live_action_support(*parts, description_of(cls))
    return support


def _support_address(cls: Any) -> int:
    """The address of the type support of a live or compiled class."""
    metaclass = type(cls)
    if metaclass._TYPE_SUPPORT is None:
        metaclass.__import_type_support__()
    return loader.capsule_pointer(metaclass._TYPE_SUPPORT)


def _new_type(cls: type[Message]) -> int:
    """Where the helper keeps a message class, whose encoder and decoder are generated when they are first called."""
    helper = _helper()
    encoder, decoder = cache(lambda: make_encoder(cls, helper)), cache(lambda: make_decoder(cls))

    def encode(message: Message) -> Payload:
        return encoder()(message)

    def decode(payload: bytes | memoryview) -> Message:
        return decoder()(payload)

    keep_object(encode)
    keep_object(decode)
    program = _Program()
    program.message(cls)
    words = array.array("I", program.words)
    name, data = keep_text(full_name(cls)), keep_data(words.tobytes())
    address: int = helper.live_new_type(name, data, len(words), encode, decode)
    if not address:
        raise NativeHelperError("This program has defined more messages than it has room for: start Python again.")
    return address


def _members(fields: tuple[MessageField, ...]) -> tuple[int, int]:
    helper = _helper()
    members = helper.live_new_members(len(fields))
    for index, field in enumerate(fields):
        kind = field.type
        helper.live_set_member(
            members,
            index,
            keep_text(field.name),
            _introspection_id(kind),
            kind.string_bound,
            _support_address(field.nested) if field.nested else None,
            bool(kind.container),
            kind.size,
            kind.container == "sequence" and kind.size > 0,
        )
    return members, len(fields)


def _introspection_id(kind: FieldType) -> int:
    if kind.primitive:
        return kind.primitive.introspection_id
    if kind.is_nested:
        return _INTROSPECTION_MESSAGE
    return _INTROSPECTION_WSTRING if kind.base == "wstring" else _INTROSPECTION_STRING


# The steps by which the helper walks a payload to see whether it is what its type says: `enum step` in helper.c.
_RUN, _STRING, _WSTRING, _VALUES, _REPEAT, _REPEAT_LIST = range(1, 7)


class _Program:
    """The program of a message class, nested messages included, as unsigned 32-bit words."""

    def __init__(self) -> None:
        self.words: list[int] = []
        self._last_step = -1  # where the last step starts, if it may be extended

    def message(self, cls: type[Message]) -> None:
        fields = message_fields(cls)
        if not fields:
            self._add_fixed_bytes(1, 1)
        for field in fields:
            self._field(field)

    def _field(self, field: MessageField) -> None:
        kind = field.type
        if not kind.container:
            self._value(field)
        elif kind.primitive and kind.container == "array":
            self._add_fixed_bytes(kind.primitive.size, kind.size)
        elif kind.primitive:
            self._step(_VALUES, kind.primitive.size, kind.size)
        else:
            self._repeat(field)

    def _value(self, field: MessageField) -> None:
        kind = field.type
        if kind.primitive:
            self._add_fixed_bytes(kind.primitive.size, 1)
        elif field.nested is not None:
            self.message(field.nested)
        else:
            self._step(_WSTRING if kind.base == "wstring" else _STRING)

    def _add_fixed_bytes(self, size: int, count: int) -> None:
        step = [_RUN, size, size]
        if self._last_step >= 0 and self.words[self._last_step : -1] == step:
            self.words[-1] += count
        else:
            self._step(*step, count)

    def _repeat(self, field: MessageField) -> None:
        self._step(_REPEAT if field.type.container == "array" else _REPEAT_LIST, field.type.size, 0)
        start = len(self.words)
        self._last_step = -1  # the body is repeated, so nothing may be merged across its ends
        self._value(field)
        self._last_step = -1
        self.words[start - 1] = len(self.words) - start

    def _step(self, *words: int) -> None:
        self._last_step = len(self.words)
        self.words += words


def _event_maker(cls: Any) -> Callable[[bytes, bytes | None, bytes | None], Payload]:
    """Make the function that builds the message service introspection publishes, out of payloads."""

    @lru_cache(maxsize=1)
    def codecs() -> tuple[Encode, Callable[[bytes], Message], Callable[[bytes], Message]]:
        return make_encoder(cls.Event, _helper()), make_decoder(cls.Request), make_decoder(cls.Response)

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


# Type descriptions as rosidl_runtime_c lays them out in memory: a String is (data, size, capacity), a sequence the
# same, and a Field is its name, its FieldType (id, capacity, string capacity, nested type) and its default value.


def description_of(cls: type) -> int:
    """Address of the helper's `struct description` of a message, service or action class."""
    classes = [cls, *referenced_classes(cls)]
    type_hash_address = keep_data(bytes([_HASH_VERSION]) + type_hash(cls))
    description = keep_data(_description(cls) + _sequence([_description(other) for other in classes[1:]]))
    sources = keep_data(_sequence([_source(other) for other in classes]))
    return keep_data(struct.pack("3Q", type_hash_address, description, sources))


@lru_cache(maxsize=512)
def _description(cls: type) -> bytes:
    described = describe_type(cls)
    return _string(described.type_name) + _sequence([_field(field) for field in described.fields])


def _field(field: DescribedField) -> bytes:
    kind = struct.pack("B7xQQ", field.type_id, field.capacity, field.string_capacity)
    return _string(field.name) + kind + _string(field.nested_type_name) + _string(field.default_value)


@lru_cache(maxsize=512)
def _source(cls: type) -> bytes:
    encoding, text = source_text(cls)
    return _string(describe_type(cls).type_name) + _string(encoding) + _string(text)


def _string(text: str) -> bytes:
    data = text.encode()
    return struct.pack("3Q", keep_text(text), len(data), len(data) + 1)


def _sequence(items: list[bytes]) -> bytes:
    return struct.pack("3Q", keep_data(b"".join(items)) if items else 0, len(items), len(items))

"""Makes C-side types with the native helper."""

from __future__ import annotations

import array
import ctypes
import struct
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

from course_kit.interfaces.codec import make_decoder, make_encoder, validation_program
from course_kit.interfaces.definition import EMPTY_MEMBER, FieldType
from course_kit.interfaces.errors import NativeHelperError
from course_kit.interfaces.message_fields import LiveType, MessageField, message_fields
from course_kit.interfaces.native.loader import function_address, keep, keep_object, keep_text, load_helper, ros_library
from course_kit.interfaces.type_description import describe, full_name, referenced_classes, source_text, type_hash

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.interfaces.codec.encoder import Encode, Payload
    from course_kit.interfaces.message_fields import Message
    from course_kit.interfaces.type_description import DescribedField

_INTROSPECTION_STRING, _INTROSPECTION_WSTRING, _INTROSPECTION_MESSAGE = 16, 17, 18
_HASH_VERSION = 1
_NO_FIELDS = (MessageField(EMPTY_MEMBER, FieldType("uint8"), None),)


class MessageSupport(NamedTuple):
    """The helper's own record of a message type, and the addresses of what rclpy wants to know of it."""

    type: LiveType
    support: int
    create: int
    destroy: int
    from_python: int
    to_python: int


class Helper:
    """The native helper of this process."""

    def __init__(self) -> None:
        self._helper = load_helper()
        introspection = ros_library("librosidl_typesupport_introspection_c.so")
        name = "rosidl_typesupport_introspection_c__identifier"
        # rmw_fastrtps compares this one by its address.
        self._introspection = ctypes.c_void_p.in_dll(introspection, name).value or 0

    def message(self, cls: type[Message], support_address: Callable[[type], int]) -> MessageSupport:
        """Make the type support of a message class; `support_address` gives those of nested messages."""
        description = description_of(cls)
        live_type = self._new_type(cls)
        helper = live_type.helper
        package, folder, name = _names(cls)
        introspection = helper.live_introspection(
            self._introspection,
            keep_text(f"{package}__{folder}"),
            keep_text(name),
            *self._members(message_fields(cls) or _NO_FIELDS, support_address),
            description,
        )
        support = helper.live_message_support(
            keep_text(f"{package}::{folder}"), keep_text(name), description, introspection
        )
        return MessageSupport(
            live_type,
            support,
            helper.live_create_function(live_type.address),
            function_address(helper.live_destroy),
            function_address(helper.live_from_python),
            function_address(helper.live_to_python),
        )

    def service(self, cls: type, parts: list[int], event: LiveType, make_event: object) -> int:
        """Make the type support of a service out of those of request, response and event; its address."""
        package, folder, name = _names(cls)
        keep_object(make_event)
        support: int = event.helper.live_service_support(
            keep_text(f"{package}::{folder}"), keep_text(name), *parts, event.address, make_event, description_of(cls)
        )
        return support

    def action(self, cls: type, parts: list[int]) -> int:
        """Make the type support of an action out of those of its two services, cancel, feedback and status."""
        support: int = self._helper.live_action_support(*parts, description_of(cls))
        return support

    def _new_type(self, cls: type[Message]) -> LiveType:
        words = array.array("I", validation_program(cls))
        codec = LazyCodec(cls)
        arguments = (keep_text(full_name(cls)), keep(words.tobytes()), len(words), codec.encode, codec.decode)
        address = self._helper.live_new_type(*arguments)
        if not address:
            raise NativeHelperError("This program has defined more messages than it has room for: start Python again.")
        codec.live_type = LiveType(self._helper, address)
        return codec.live_type

    def _members(self, fields: tuple[MessageField, ...], support_address: Callable[[type], int]) -> tuple[int, int]:
        members = self._helper.live_new_members(len(fields))
        for index, field in enumerate(fields):
            kind = field.type
            self._helper.live_set_member(
                members,
                index,
                keep_text(field.name),
                _introspection_id(kind),
                kind.string_bound,
                support_address(field.nested) if field.nested else None,
                bool(kind.container),
                kind.size,
                kind.container == "sequence" and kind.size > 0,
            )
        return members, len(fields)


class LazyCodec:
    """Encoder and decoder of a class as the helper first gets them: each is generated when it is first called."""

    def __init__(self, cls: type[Message]) -> None:
        self.live_type: LiveType | None = None
        self._cls = cls
        self._encoder: Encode | None = None
        self._decoder: Callable[[bytes | memoryview], Message] | None = None
        self.encode, self.decode = self._first_encode, self._first_decode
        keep_object(self.encode)
        keep_object(self.decode)

    def _first_encode(self, message: Message) -> Payload:
        assert self.live_type is not None  # noqa: S101 - the helper calls only for types it has
        self._encoder = self._encoder or make_encoder(self._cls, self.live_type.helper)
        self._tell_helper()
        return self._encoder(message)

    def _first_decode(self, payload: bytes | memoryview) -> Message:
        self._decoder = self._decoder or make_decoder(self._cls)
        self._tell_helper()
        return self._decoder(payload)

    def _tell_helper(self) -> None:
        encode, decode = self._encoder or self.encode, self._decoder or self.decode
        keep_object(encode)
        keep_object(decode)
        assert self.live_type is not None  # noqa: S101 - the helper calls only for types it has
        self.live_type.helper.live_set_codec(self.live_type.address, encode, decode)


def _introspection_id(kind: FieldType) -> int:
    if kind.primitive:
        return kind.primitive.introspection_id
    if kind.is_nested:
        return _INTROSPECTION_MESSAGE
    return _INTROSPECTION_WSTRING if kind.base == "wstring" else _INTROSPECTION_STRING


def _names(cls: type) -> tuple[str, str, str]:
    package, folder, name = full_name(cls).split("/")
    return package, folder, name


# Type descriptions as rosidl_runtime_c lays them out in memory: a String is (data, size, capacity), a sequence the
# same, and a Field is its name, its FieldType (id, capacity, string capacity, nested type) and its default value.


def description_of(cls: type) -> int:
    """Address of the helper's `struct description` of a message, service or action class."""
    classes = [cls, *referenced_classes(cls)]
    type_hash_address = keep(bytes([_HASH_VERSION]) + type_hash(cls))
    description = keep(_individual(cls) + _sequence([_individual(other) for other in classes[1:]]))
    sources = keep(_sequence([_source(other) for other in classes]))
    return keep(struct.pack("3Q", type_hash_address, description, sources))


@lru_cache(maxsize=512)
def _individual(cls: type) -> bytes:
    described = describe(cls)
    return _string(described.type_name) + _sequence([_field(field) for field in described.fields])


def _field(field: DescribedField) -> bytes:
    kind = struct.pack("B7xQQ", field.type_id, field.capacity, field.string_capacity)
    return _string(field.name) + kind + _string(field.nested_type_name) + _string(field.default_value)


@lru_cache(maxsize=512)
def _source(cls: type) -> bytes:
    encoding, text = source_text(cls)
    return _string(describe(cls).type_name) + _string(encoding) + _string(text)


def _string(text: str) -> bytes:
    data = text.encode()
    return struct.pack("3Q", keep_text(text), len(data), len(data) + 1)


def _sequence(items: list[bytes]) -> bytes:
    return struct.pack("3Q", keep(b"".join(items)) if items else 0, len(items), len(items))

"""What arrives over the wire: malformed payloads are dropped as compiled types drop them."""

from __future__ import annotations

import random
import struct
from typing import TYPE_CHECKING, Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces.codec.encoder import make_decoder
from tests.interfaces.twins import PACKAGES, message_twins, random_message, seeded

if TYPE_CHECKING:
    import random


def read(payload: bytes, cls: Any) -> str | None:
    """The message as text, None if the payload is refused."""
    try:
        return repr(deserialize_message(payload, cls))
    except Exception as error:
        if type(error).__name__ != "RMWError":  # it cannot be imported
            raise
        return None


def mutations(payload: bytes, rng: random.Random) -> list[bytes]:
    def with_bytes(*changes: tuple[int, int]) -> bytes:
        changed = bytearray(payload)
        for at, value in changes:
            changed[at % len(changed)] = value
        return bytes(changed)

    somewhere = range(4, max(len(payload), 5))
    return [
        payload[: rng.randrange(len(payload) + 1)],
        payload[:-1],
        payload[:4],
        *(with_bytes((rng.choice(somewhere), rng.choice([0, 1, 2, 127, 255, rng.randrange(256)]))) for _ in range(4)),
        with_bytes(*((at, 255) for at in range(rng.choice(somewhere), len(payload)))),
        with_bytes((1, rng.choice([2, 3, 9, 255]))),
        with_bytes((0, 1)),
        payload + bytes(rng.randrange(1, 4)),
    ]


def is_lenient(payload: bytes, live: Any) -> bool:
    """Whether it takes the leniency of compiled types to read this.

    They read encodings that Fast DDS does not write here, do not mind what follows the last field, and forget that
    reading a nested message has failed.
    """
    if payload[:2] != b"\0\1":
        return True
    return not decodes(payload, live) or decodes(payload[:-4], live)


def decodes(payload: bytes, live: Any) -> bool:
    try:
        make_decoder(live)(payload)
    except (ValueError, struct.error):
        return False
    return True


@pytest.mark.parametrize("package", PACKAGES)
def test_malformed_payloads_are_refused_or_read_alike(package: str) -> None:
    rng = seeded(package)
    accepted = refused = 0
    for compiled, live in message_twins(package):
        for payload in mutations(serialize_message(random_message(compiled, rng)), rng):
            ours, theirs = read(payload, live), read(payload, compiled)
            refused += ours is None
            accepted += ours is not None
            if ours is not None or (theirs is not None and not is_lenient(payload, live)):
                assert ours == theirs, (compiled, payload.hex())
    assert accepted
    assert refused

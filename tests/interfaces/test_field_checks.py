"""What a field takes and what it refuses, with and without ROS_PYTHON_CHECK_FIELDS, is as in compiled classes."""

from __future__ import annotations

import array
from typing import Any

import numpy as np
import pytest
from geometry_msgs.msg import Point, Pose

from tests.interfaces.twins import message_twins

ODD_VALUES: list[Any] = [
    *(None, 1, -1, 256, 2**31, 2**63, -(2**63) - 1, 1.5, 1e39, float("inf"), float("nan"), True),
    *("", "x", "x" * 9, "é" * 8, b"", b"a", b"ab", bytearray(b"a"), range(3), (1, 2), {1}),
    *([], [1], [True], [1, 2, 3], [1, 2, 3, 4], ["a", "b", "c"], ["a"], [b"a"], [b"ab"], [b"a"] * 3, [1.5] * 3),
    *(Pose(), Point(), [Pose()], [Point()], [300, 1, 1], [1e39, 1.0, 1.0]),
    *(array.array("B", [1]), array.array("d", [1]), array.array("q", [1, 2, 3, 4]), array.array("i", [1])),
    *(np.zeros(3, "f4"), np.zeros(3, "f8"), np.zeros(4, "f4"), np.zeros(3, "u1")),
]


def outcome(target: Any, name: str, value: Any) -> str:
    """Of a value for a field of a message, or for one that its class makes."""
    try:
        if isinstance(target, type):
            message = target(check_fields=True, **{name: value})
        else:
            message = target
            setattr(message, name, value)
    except AssertionError as error:
        return f"refused: {error}"
    except Exception as error:  # noqa: BLE001 - which one is the outcome compared
        return f"failed: {type(error).__name__}"
    return f"{type(getattr(message, name)).__name__} {getattr(message, name)!r}"


# Compiled classes of Jazzy import collections.abc.ByteString, which is deprecated and gone in Python 3.14.
NO_BYTE_STRING = "failed: ImportError"


@pytest.mark.filterwarnings("ignore:.*ByteString:DeprecationWarning")
@pytest.mark.parametrize("package", ["test_msgs", "sensor_msgs", "std_srvs", "unique_identifier_msgs"])
def test_fields_accept_and_refuse_the_same(package: str) -> None:
    for compiled, live in message_twins(package):
        if "_" in live.__name__ and package == "test_msgs":
            continue  # parts of services and actions have the same fields as its messages
        pairs = [(compiled, live), *((compiled(check_fields=how), live(check_fields=how)) for how in (True, False))]
        for name in compiled.get_fields_and_field_types():
            for value in ODD_VALUES:
                for their, our in pairs:
                    theirs, ours = outcome(their, name, value), outcome(our, name, value)
                    assert theirs in (ours.partition(": write ")[0], NO_BYTE_STRING), (compiled, name, value, type(our))

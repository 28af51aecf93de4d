"""What is typed as YAML, put into messages."""

from __future__ import annotations

import math

import pytest
from geometry_msgs.msg import PoseStamped, Twist
from std_msgs.msg import ByteMultiArray, Float32, Header, Int8, String, UInt8MultiArray
from std_srvs.srv import SetBool
from test_msgs.msg import Arrays, BoundedSequences

from course_kit.ros2cli import values
from course_kit.ros2cli.session import CommandError


@pytest.mark.parametrize(
    ("message", "text", "field", "wanted"),
    [
        (SetBool.Request(), "{data: true}", "data", True),
        (String(), "data: 5", "data", "5"),
        (Int8(), "data: '7'", "data", 7),
        (Float32(), "data: 1e3", "data", 1000.0),
        (ByteMultiArray(), "data: [!!binary AA==, !!binary /w==]", "data", [b"\x00", b"\xff"]),
    ],
)
def test_values_that_fit(message: object, text: str, field: str, wanted: object) -> None:
    values.fill_message(message, text, "m")
    found = getattr(message, field)
    assert (list(found) if isinstance(wanted, list) else found) == wanted


def test_messages_inside_messages() -> None:
    twist = Twist()
    values.fill_message(twist, "{linear: {x: 2}, angular: {z: -.5}}", "m")
    assert (twist.linear.x, twist.angular.z, twist.linear.y) == (2.0, -0.5, 0.0)


def test_lists_of_messages_and_fixed_arrays() -> None:
    arrays = Arrays()
    values.fill_message(arrays, "{int32_values: [1, 2, 3], string_values: [a, b, c]}", "m")
    assert list(arrays.int32_values) == [1, 2, 3]
    assert list(arrays.string_values) == ["a", "b", "c"]


def test_now_and_auto_are_the_time() -> None:
    pose, header = PoseStamped(), Header()
    values.fill_message(pose, "header: auto", "m")
    values.fill_message(header, "stamp: now", "m")
    assert pose.header.stamp.sec > 1e9
    assert header.stamp.sec > 1e9


def test_not_a_number_is_a_float() -> None:
    message = Float32()
    values.fill_message(message, "data: .nan", "m")
    assert math.isnan(message.data)


@pytest.mark.parametrize(
    ("message", "text", "wanted"),
    [
        (SetBool.Request(), "{data: 1.5}", "The field 'data' is a bool; 1.5 is a float."),
        (SetBool.Request(), "{dta: true}", "There is no field 'dta' in m; it has data. Did you mean 'data'?"),
        (Int8(), "{data: 128}", "The field 'data' is an int8, from -128 to 127; 128 is out of range."),
        (Float32(), "{data: 1.0e+39}", "The field 'data' is a float32; 1e+39 is out of range."),
        (Int8(), "{data:1}", "YAML wants a blank behind the colon: write data: 1, not data:1."),
        (String(), "hello", "m takes its fields as '{data: ...}', not 'hello'."),
        (Twist(), "{linear: {w: 1}}", "There is no field 'w' in linear, a geometry_msgs/Vector3; it has x, y, z."),
        (UInt8MultiArray(), "{data: [1, 256]}", "The field 'data[1]' is a uint8, from 0 to 255; 256 is out of range."),
        (Arrays(), "{int32_values: [1, 2]}", "The field 'int32_values' takes exactly 3 values, not 2."),
        (BoundedSequences(), "{int32_values: [1, 2, 3, 4]}", "The field 'int32_values' takes at most 3 values, not 4."),
        (String(), "{data: hi", "The values are not valid YAML: expected ',' or '}', but got '<stream end>' in line 1"),
    ],
)
def test_values_that_do_not_fit_are_named(message: object, text: str, wanted: str) -> None:
    with pytest.raises(CommandError) as caught:
        values.fill_message(message, text, "m")
    said = str(caught.value)
    assert said.startswith(wanted)
    assert len(said.splitlines()) == 1

"""One way to fill a message, from a program and from what was typed: an error names the field and its message."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import yaml
from geometry_msgs.msg import Point, Pose
from std_msgs.msg import Byte, ByteMultiArray, UInt8MultiArray

from course_kit.ros.filling import fill_from_yaml, make_message
from course_kit.ros.messages import BadFieldError

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.ros.filling import Fields


def typed(fields: Fields) -> None:
    fill_from_yaml(Pose(), fields, "a pose")


def given(fields: Fields) -> None:
    make_message(Pose, fields, "a pose")


@pytest.mark.parametrize("fill", [given, typed])
@pytest.mark.parametrize(
    ("fields", "said"),
    [
        (
            {"positon": {}},
            "There is no field 'positon' in a pose; it has position, orientation. Did you mean 'position'?",
        ),
        ({"position": {"q": 1.0}}, "There is no field 'q' in position, a geometry_msgs/Point; it has x, y, z."),
    ],
)
def test_both_say_the_same_of_a_field_that_is_not_there(
    fill: Callable[[Fields], None], fields: Fields, said: str
) -> None:
    with pytest.raises(BadFieldError) as caught:
        fill(fields)
    assert str(caught.value).startswith(said)


def test_only_what_was_typed_is_made_to_fit() -> None:
    point = Point()
    fill_from_yaml(point, {"x": 1, "y": "2.5"}, "a point")
    assert (point.x, point.y) == (1.0, 2.5)
    with pytest.raises(BadFieldError, match=r"takes a float: write 1\.0"):
        make_message(Point, {"x": 1}, "a point")


def test_a_byte_is_what_yaml_calls_binary() -> None:
    """ros2cli issue 760: the only way to fill a byte in ROS 2, which refuses numbers."""
    one, many = Byte(), ByteMultiArray()
    fill_from_yaml(one, yaml.safe_load("{data: !!binary Aw==}"), "a byte")
    fill_from_yaml(many, yaml.safe_load("{data: [!!binary AQ==, !!binary Ag==]}"), "bytes")
    assert (one.data, many.data) == (b"\3", [b"\1", b"\2"])
    image = UInt8MultiArray()
    fill_from_yaml(image, yaml.safe_load("{data: !!binary AQI=}"), "an image")
    assert list(image.data) == [1, 2]
    with pytest.raises(BadFieldError, match=r"'data' is a byte; 3 is an integer\. Write !!binary Aw== in its place"):
        fill_from_yaml(Byte(), {"data": 3}, "a byte")
    with pytest.raises(BadFieldError, match=r"'data\[0\]' is a byte; 1 is an integer\. Write !!binary AQ=="):
        fill_from_yaml(ByteMultiArray(), {"data": [1]}, "bytes")


def test_a_colon_without_a_blank_behind_it_is_said() -> None:
    with pytest.raises(BadFieldError, match=r"YAML wants a blank behind the colon: write x: 1, not x:1"):
        fill_from_yaml(Pose(), {"position": yaml.safe_load("{x:1, y: 2}")}, "a pose")

"""Messages in words, and the small copies of them that these are made of."""

from __future__ import annotations

from geometry_msgs.msg import Pose
from sensor_msgs.msg import Image
from std_msgs.msg import String

from course_kit.ros.showing import CHARACTERS, ELEMENTS, copy_message, describe_message


def test_values_in_words() -> None:
    assert describe_message(copy_message(String(data="it's"))) == 'data="it\'s"'
    assert describe_message(copy_message(Pose())).startswith("position={x=0.0, y=0.0, z=0.0}, orientation={x=0.0")
    assert describe_message({"a": 2.346}, 2) == "a=2.35"
    assert describe_message({}) == "(empty)"
    assert describe_message("ValueError") == "'ValueError'"
    assert len(describe_message({"a": "x" * 500})) == 160


def test_long_values_are_cut_when_they_are_copied() -> None:
    image = copy_message(Image(data=bytes(1_000_000), encoding="x" * 1000))
    assert len(image["data"]) == ELEMENTS + 1
    assert image["data"][-1] == f"+{1_000_000 - ELEMENTS} more"
    assert len(image["encoding"]) == CHARACTERS
    assert describe_message({"data": image["data"]}) == "data=[0, 0, 0, 0, 0, 0, 0, 0, +999992 more]"

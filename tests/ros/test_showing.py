"""Messages in words, and the small copies of them that these are made of."""

from __future__ import annotations

from geometry_msgs.msg import Pose
from sensor_msgs.msg import Image
from std_msgs.msg import Header, String

from course_kit.ros.showing import CHARACTERS, ELEMENTS, in_words, rows, snapshot


def test_values_in_words() -> None:
    assert in_words(snapshot(String(data="it's"))) == 'data="it\'s"'
    assert in_words(snapshot(Pose())).startswith("position={x=0.0, y=0.0, z=0.0}, orientation={x=0.0")
    assert in_words({"a": 2.346}, 2) == "a=2.35"
    assert in_words({}) == "(empty)"
    assert in_words("ValueError") == "'ValueError'"
    assert len(in_words({"a": "x" * 500})) == 160


def test_long_values_are_cut_when_they_are_copied() -> None:
    image = snapshot(Image(data=bytes(1_000_000), encoding="x" * 1000))
    assert len(image["data"]) == ELEMENTS + 1
    assert image["data"][-1] == f"+{1_000_000 - ELEMENTS} more"
    assert len(image["encoding"]) == CHARACTERS
    assert in_words({"data": image["data"]}) == "data=[0, 0, 0, 0, 0, 0, 0, 0, +999992 more]"


def test_rows_take_messages_apart() -> None:
    assert rows(snapshot(Header(frame_id="map"))) == [
        ["stamp.sec", "0"],
        ["stamp.nanosec", "0"],
        ["frame_id", "'map'"],
    ]

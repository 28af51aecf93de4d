"""What stands beside the fields of an interface's text."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from course_interfaces.action import MoveRobot
from course_interfaces.srv import ConvertTemperature
from geometry_msgs.msg import Point
from std_srvs.srv import SetBool

from course_kit import interfaces
from course_kit.interfaces.comments import comments_of, split_comment

if TYPE_CHECKING:
    from course_kit.interfaces.message_fields import Message


@pytest.mark.parametrize(
    ("message", "comments"),
    [
        (ConvertTemperature.Response, ["false if the value or a unit makes no sense", "in to_unit"]),
        (MoveRobot.Feedback, ["metres", "metres", "0.0 at the start .. 1.0 at the target"]),
        (SetBool.Request, ["e.g. for hardware enabling / disabling"]),
        (Point, []),
    ],
)
def test_each_part_has_its_own(message: type[Message], comments: list[str]) -> None:
    assert list(comments_of(message).values())[: len(comments)] == comments


def test_headings_and_constants_are_left_out() -> None:
    defined = interfaces.define("notes_test/msg/Note", "# a heading\nfloat64 MOST=2.0 # m\nfloat64 far # m\nstring a\n")
    assert comments_of(defined) == {"far": "m"}


def test_a_line_is_split_at_its_comment() -> None:
    assert split_comment('string name "a # b"  # who') == ('string name "a # b"', "who")

"""What is kept of what a submission sends: a little of each, whatever comes."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import pytest
from action_msgs.msg import GoalStatus, GoalStatusArray
from course_interfaces.action import MoveRobot
from course_interfaces.srv import ConvertTemperature
from hypothesis import given
from hypothesis import strategies as st
from rcl_interfaces.msg import ListParametersResult, ParameterValue
from rcl_interfaces.srv import GetParameters
from rclpy.serialization import serialize_message
from std_msgs.msg import String

from course_kit.grading import engine
from course_kit.grading.checks import grader_node
from course_kit.grading.checks.grader_node import ActionChannels, BoundedInbox

INFO = {"received_timestamp": 2_000_000_000, "source_timestamp": 1_000_000_000}
TEXTS = ("sent", "expected", "got", "message")
NOBODY: Any = SimpleNamespace(node=None, client=lambda *_: None, listen=lambda *_, **__: None)


def take(keep: Any, message: Any) -> None:
    handle = SimpleNamespace(take_message=lambda *_: (message, INFO))
    assert grader_node._take_message(SimpleNamespace(handle=handle, msg_type=None, raw=False), keep)


def test_texts_and_sequences_of_a_message_are_cut_wherever_they_stand() -> None:
    assert len(grader_node.bound_message(String(data="x" * 5_000_000)).data) == grader_node.LONGEST_TEXT
    assert grader_node.bound_message(String(data="short")).data == "short"
    long = grader_node.bound_message(ConvertTemperature.Response(message="x" * 5_000_000))
    assert len(long.message) == grader_node.LONGEST_TEXT
    names = grader_node.bound_message(ListParametersResult(names=[*["x" * 10_000] * 5000, "the last"])).names
    assert (len(names), len(names[0]), names[-1]) == (grader_node.MOST_ELEMENTS, grader_node.LONGEST_TEXT, "the last")
    value = ParameterValue(type=6, bool_array_value=[True] * 5000, string_value="x" * 10_000)
    value.byte_array_value = [b"x"] * 5000
    value.double_array_value = [0.5] * 5000
    found = grader_node.bound_message(GetParameters.Response(values=[value])).values[0]
    assert {len(found.bool_array_value), len(found.byte_array_value), len(found.double_array_value)} == {1000}
    assert len(found.string_value) == grader_node.LONGEST_TEXT


def test_of_a_flood_on_a_topic_the_last_messages_are_kept_and_all_are_counted() -> None:
    heard = BoundedInbox()
    for number in range(5000):
        take(heard.keep, String(data=f"{number} {'x' * 20_000}"))
    assert heard.count == 5000
    assert len(heard.messages) == len(heard.times) == 1000
    assert sum(len(message.data) for message in heard.messages) <= 1000 * grader_node.LONGEST_TEXT
    assert [message.data.split()[0] for message in heard.newer_than(4998)] == ["4998", "4999"]
    assert len(heard.newer_than(0)) == 1000
    assert heard.newer_than(5000) == []


def feedback(goal: bytes, number: int) -> Any:
    return SimpleNamespace(goal_id=SimpleNamespace(uuid=goal), feedback=MoveRobot.Feedback(progress=float(number)))


def test_of_feedback_without_end_the_beginning_and_the_last_are_kept() -> None:
    ours, other, channels = b"a" * 16, b"b" * 16, ActionChannels(NOBODY, "/move_robot", MoveRobot)
    told, _ = channels.follow(ours)
    for number in range(12_000):
        take(channels.keep_feedback, feedback(ours, number))
        take(channels.keep_feedback, feedback(other, number))
    assert len(told) == 10_000
    assert [told[place].feedback.progress for place in (0, 1, -2, -1)] == [0, 1, 9998, 11_999]
    assert channels.follow(other)[0] == []


def test_only_changes_of_the_status_of_our_own_goals_are_kept() -> None:
    ours, channels = bytes(range(16)), ActionChannels(NOBODY, "/move_robot", MoveRobot)
    _, changes = channels.follow(ours)
    for status in (1, 2, 2, 2, 77, 4, 4, *range(-30, 0)):
        entries = [GoalStatus(status=status) for _ in range(1100)]
        entries[-1].goal_info.goal_id.uuid = list(ours)
        take(channels.keep_statuses, serialize_message(GoalStatusArray(status_list=entries)))
    assert [status for _, status in changes[:4]] == [1, 2, 77, 4]
    assert len(changes) == 20


@given(st.text(st.characters(exclude_categories=()), max_size=200), st.integers(10, 100))
def test_a_cut_text_is_as_short_as_it_was_asked_to_be_and_can_be_written(text: str, longest: int) -> None:
    found = engine.cut_text(text, longest)
    assert len(json.dumps(found, ensure_ascii=False).encode()) - 2 <= longest
    if text.isascii() and text.isprintable() and len(text) <= longest - 20 and not set(text) & set('"\\'):
        assert found == text
    assert found.endswith("...") or len(found) == len(text)


def result(**texts: str) -> dict[str, Any]:
    return {**dict.fromkeys(TEXTS, ""), "id": "x", "steps": [], "graph": None, **texts}


@pytest.mark.parametrize("letter", ["x", "\x01", "\U0001f600", '"', "\ud800"])
def test_all_results_together_are_short(letter: str) -> None:
    step = {"sender": "grader", "receiver": "your node", "kind": "request", "text": letter * 100_000}
    long = result(**dict.fromkeys(TEXTS, letter * 1_000_000)) | {"steps": [step] * 500}
    found = engine.bound_results([long] * 50)
    assert (
        sum(len(json.dumps({name: one[name] for name in TEXTS}, ensure_ascii=False).encode()) for one in found)
        < 170_000
    )
    assert all(one["got"].endswith("...") for one in found)
    assert len(json.dumps(found)) < 2_000_000
    assert engine.bound_results([result(got="as it was")]) == [result(got="as it was")]

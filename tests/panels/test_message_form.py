"""Any message as a form, and what was typed there as a message again."""

from __future__ import annotations

from typing import Any

import pytest
from geometry_msgs.msg import Point, Pose, PoseArray

from course_kit import interfaces
from course_kit.panels.message_form import FormError, MessageForm, fields_in_words

EVERYTHING = """
string CELSIUS=celsius
string FAHRENHEIT=fahrenheit
uint8 MODE_SLOW=1
uint8 MODE_FAST=2
float64 value 1.5
string unit celsius
uint8 mode
uint8 other
bool loud true
string<=5 code
float64[3] offset
int32[<=4] numbers
byte raw
string[<=2] words
geometry_msgs/Point[] points
geometry_msgs/Pose pose
"""


MODES = ["MODE_SLOW", "MODE_FAST"]


@pytest.fixture(scope="module")
def everything() -> Any:
    return interfaces.define("form_interfaces/msg/Everything", EVERYTHING)


def entry(form: MessageForm, path: str) -> dict[str, Any]:
    found, entries = None, form.entries()
    for name in path.split("."):
        found = next(one for one in entries if one["name"] == name)
        entries = found.get("fields", [])
    assert found
    return found


def refused(form: MessageForm, path: str, value: object) -> str:
    with pytest.raises(FormError) as caught:
        form.read({path: value})
    assert list(caught.value.fields) == [path]
    return caught.value.fields[path]


def test_untouched_it_gives_the_message_with_its_defaults(everything: Any) -> None:
    form = MessageForm(everything)
    assert form.read(form.defaults()) == everything()
    assert form.read({}) == everything()
    assert form.defaults()["value"] == "1.5"
    assert form.defaults()["loud"] is True


def test_what_is_typed_arrives_in_the_message_wherever_it_is(everything: Any) -> None:
    form = MessageForm(everything)
    message = form.read(
        {
            "value": " -2e3 ",
            "unit": " as typed ",
            "mode": "16",
            "loud": False,
            "offset": "[1, 2.5, 3]",
            "numbers": "4, -5",
            "raw": "7",
            "words": "'hello, you'",
            "points": "{}, {y: 2}",
            "pose.orientation.w": "0.5",
        }
    )
    assert (message.value, message.unit, message.mode, message.loud) == (-2000.0, " as typed ", 16, False)
    assert list(message.offset) == [1.0, 2.5, 3.0]
    assert list(message.numbers) == [4, -5]
    assert (message.raw, message.words) == (b"\x07", ["hello, you"])
    assert [point.y for point in message.points] == [0.0, 2.0]
    assert (message.pose.orientation.w, message.pose.position.x) == (0.5, 0.0)


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("mode", "256", "Expected a whole number (uint8, from 0 to 255), not '256'."),
        ("mode", "1.5", "Expected a whole number (uint8, from 0 to 255), not '1.5'."),
        ("value", "", "Expected a number (float64), not ''."),
        ("code", "sixsix", "Expected text, up to 5 characters (string<=5), not 'sixsix'."),
        ("offset", "1, 2", "Expected 3 numbers, with commas (float64[3]), not '1, 2'."),
        ("numbers", "1, x", "Expected up to 4 whole numbers, with commas (int32[<=4], from -2147483648 to"),
        ("words", "a, b, c", "Expected up to 2 texts, with commas (string[<=2]), not 'a, b, c'."),
        ("points", "{w: 1}", "Expected messages, with commas, each as {field: value, ...} (geometry_msgs/P"),
        ("pose.position.x", "left", "Expected a number (float64), not 'left'."),
    ],
)
def test_what_a_field_cannot_take_is_refused_with_its_name_and_the_reason(
    everything: Any, path: str, value: str, expected: str
) -> None:
    assert refused(MessageForm(everything), path, value).startswith(expected)


def test_constants_are_offered_where_they_fit(everything: Any) -> None:
    form = MessageForm(everything)
    names = {path: [one["name"] for one in entry(form, path)["choices"]] for path in ("unit", "code", "mode", "other")}
    # "celsius" is too long for the code.
    assert names == {"unit": ["CELSIUS", "FAHRENHEIT"], "code": [], **dict.fromkeys(("mode", "other"), MODES)}
    assert entry(form, "value")["choices"] == []


def test_a_list_in_a_list_element_and_a_fixed_list_of_messages() -> None:
    path = interfaces.define("form_interfaces/msg/Path", "string name\ngeometry_msgs/Point[2] ends\nstring[] tags")
    paths = interfaces.define("form_interfaces/msg/Paths", "form_interfaces/Path[] paths")
    typed = "{name: way, tags: [fast], ends: [{}, {x: 4}]}"
    wanted = path(name="way", tags=["fast"], ends=[path().ends[0], Point(x=4.0)])
    assert MessageForm(paths).read({"paths": typed}) == MessageForm(paths).read({"paths": f"[{typed}]"})
    assert MessageForm(paths).read({"paths": typed}) == paths(paths=[wanted])
    form = MessageForm(path)
    assert form.defaults()["ends"] == "[{x: 0.0, y: 0.0, z: 0.0}, {x: 0.0, y: 0.0, z: 0.0}]"
    assert form.read({"ends": form.defaults()["ends"].replace("x: 0.0", "x: 2")}).ends[1].x == 2.0


def test_compiled_types_work_the_same_way() -> None:
    form = MessageForm(PoseArray)
    message = form.read({"header.frame_id": "map", "poses": "{position: {x: 1}}"})
    assert (message.header.frame_id, message.poses[0].position.x) == ("map", 1.0)
    assert message.poses[0].orientation == Pose().orientation


def test_fields_in_words_are_spelled_as_in_a_definition(everything: Any) -> None:
    words = fields_in_words(everything)
    assert words.startswith(
        "value (float64), unit (string), mode (uint8), other (uint8), loud (bool), code (string<=5)"
    )
    assert "numbers (int32[<=4]), raw (byte), words (string[<=2]), points (geometry_msgs/Point[])" in words
    assert fields_in_words(interfaces.define("form_interfaces/msg/Nothing", "")) == "none"

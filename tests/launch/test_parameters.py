"""The values that reach a node's parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import yaml

from course_kit.launch.entity import LaunchContext
from course_kit.launch.errors import LaunchError
from course_kit.launch.node import ParameterValue, values_of
from course_kit.launch.substitutions import LaunchConfiguration, TextSubstitution

if TYPE_CHECKING:
    from collections.abc import Callable

    Run = Callable[..., str]


def given(text: str) -> TextSubstitution:
    return TextSubstitution(text=text)


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ([1, 2.5], [1.0, 2.5]),  # as they stand, the node would die of them
        ([1, 2], [1, 2]),
        (["a", "1"], ["a", "1"]),
        ([[given("1")], [given("2.5")]], [1.0, 2.5]),
        ([given("sp"), "eed"], "speed"),
        (LaunchConfiguration("empty"), ""),  # what nobody has set is an empty text, and not null
        (given("2.0"), 2.0),
        (given("[1, 2.5]"), [1.0, 2.5]),
        (given("true"), True),
        ("2.0", "2.0"),
        (ParameterValue(given("2.0"), value_type=str), "2.0"),
        (ParameterValue(given("@foo"), value_type=str), "@foo"),
        (ParameterValue(given("2"), value_type=float), 2.0),
        (ParameterValue(given("[1, 2]"), value_type=list[float]), [1.0, 2.0]),
        (ParameterValue(given("no"), value_type=bool), False),
        (ParameterValue([given("a"), "b"]), "ab"),
    ],
)
def test_the_value_and_its_type(value: object, expected: object) -> None:
    found = values_of({"v": value}, LaunchContext({"empty": ""}))["v"]
    assert found == expected
    assert (
        [type(part) for part in found] == [type(part) for part in expected]
        if isinstance(expected, list)
        else (type(found) is type(expected))
    )


def test_names_within_names() -> None:
    found = values_of({"arm": {given("joint"): {"speed": 1}}, ("a", given("b")): 2}, LaunchContext())
    assert found == {"arm.joint.speed": 1, "ab": 2}


@pytest.mark.parametrize(
    ("value", "wanted"),
    [
        (given("@foo"), "'v' has the value '@foo', which YAML cannot read. To have the text as it is, write Parameter"),
        (given("null"), "'v' has the value 'null': expected a bool, int, float, str or a list of one of these"),
        (given("{a: 1}"), "has the value '{a: 1}'"),
        (["a", 1], "all elements of a list have one type"),
        ([], "is an empty list, whose type ROS 2 cannot know"),
        (None, "has the value None"),
        (ParameterValue(given("fast"), value_type=float), "ParameterValue('fast') is no float"),
        (ParameterValue(given("2.5"), value_type=int), "ParameterValue('2.5') is no int"),
    ],
)
def test_a_value_that_no_parameter_has(value: object, wanted: str) -> None:
    with pytest.raises(LaunchError) as told:
        values_of({"v": value}, LaunchContext())
    assert wanted in str(told.value)


def test_each_node_gets_its_own_file(run: Run) -> None:
    done = run(
        "DeclareLaunchArgument('v', default_value=''),"
        "Node(executable='tell.py', name='n', namespace='ns', parameters=[{'list': [1, 2.5],"
        " 'text': LaunchConfiguration('v')}], output='screen')"
    )
    lines = [line.removeprefix("[tell.py-1] ") for line in done.splitlines() if line.startswith("[tell.py-1]")]
    assert "'--ros-args', '-r', '__node:=n', '-r', '__ns:=/ns'" in lines[0]
    whole = yaml.safe_load("\n".join(lines[1:]))
    assert whole == {"/ns/n": {"ros__parameters": {"list": [1.0, 2.5], "text": ""}}}

"""Faults in a definition are reported with their line, the line itself, and what was expected there."""

from __future__ import annotations

import pytest

from course_kit import environment, interfaces
from course_kit.interfaces import InterfaceDefinitionError
from course_kit.interfaces.parser import parse_definition


def fault(text: str, type_name: str = "my_interfaces/msg/Info") -> InterfaceDefinitionError:
    with pytest.raises(InterfaceDefinitionError) as caught:
        parse_definition(type_name, text)
    return caught.value


FAULTS = {
    "sting name": "did you mean string?",
    "float speed": "did you mean float32 or float64?",
    "double speed": "did you mean float64?",
    "time stamp": "did you mean builtin_interfaces/Time",
    "qqqq name": "expected a basic type such as int64",
    "int64": "Expected a type and a name, such as: int64 value",
    "name string": "Expected the type first and the name second: string name",
    "int64 2nd": "cannot name a field",
    "int64 größe": "cannot name a field",
    "int64 check_fields": "cannot be called 'check_fields'",
    "int64 a, b": "Expected one field a line",
    "name: string": "Expected the type first and the name second: string name",
    "int64[0] a": "'0' is not a size: expected a number of elements, such as [3] or [<=10], or []",
    "int64<=3 a": "Only string and wstring take a bound",
    "string<5 a": "is not a type",
    "int8 a 128": "Expected a whole number from -128 to 127, not '128'.",
    "int32 a 1.5": "Expected a whole number",
    "bool a yes": "Expected true or false, not 'yes'.",
    'string a "x': 'Expected the text to end with "',
    'string a "x # y"': "A # starts a comment, even inside quotes.",
    'string a "x"y"': 'to be written \\"',
    "int32[2] a 1": "in brackets, such as [1, 2, 3]",
    "int32[2] a [1]": "Expected exactly 2 values in the brackets, not 1.",
    "int8[] a [1, 300]": "Expected a whole number from -128 to 127, not '300'.",
    "int32 limit=3": "'limit' cannot name a constant: expected capitals, such as LIMIT.",
    "int32 A__B=3": "cannot name a constant",
    "int32[] LIMITS=3": "A constant has a basic type",
    "geometry_msgs/Point HOME=0": "A constant has a basic type",
    "string<=5 UNIT=metre": "A constant has a basic type",
}


@pytest.mark.parametrize("line", FAULTS)
def test_the_line_and_what_was_expected(line: str) -> None:
    error = fault(f"# A comment.\nint64 fine\n{line}\n")
    assert (error.line, error.text) == (3, line)
    assert FAULTS[line] in error.expected
    assert str(error).startswith(f"my_interfaces/msg/Info, line 3: {line.strip()!r}. ")
    assert FAULTS[line] in str(error)


@pytest.mark.parametrize(("again", "what"), [("string name", "field 'name'"), ("int32 A=1\nint32 A=2", "constant 'A'")])
def test_a_name_twice(again: str, what: str) -> None:
    error = fault(f"int32 name\n{again}")
    first = 1 if what.startswith("field") else 2
    assert error.line == first + 1
    assert f"There is a {what} already, in line {first}" in error.expected


SEPARATORS = [
    ("srv", "int64 a\nint64 b\n", 0, "needs exactly one line of '---' (request, ---, response); found 0"),
    ("srv", "int64 a\n---\nint64 b\n---\nint64 c", 4, "has exactly one line of '---'"),
    ("srv", "int64 a\n ---\nint64 b", 2, "Expected '---', three hyphens at the start of the line"),
    (
        "action",
        "int64 a\n---\nint64 b",
        0,
        "needs exactly two lines of '---' (goal, ---, result, ---, feedback); found 1",
    ),
]


@pytest.mark.parametrize(("kind", "text", "line", "expected"), SEPARATORS)
def test_separators(kind: str, text: str, line: int, expected: str) -> None:
    error = fault(text, f"my_interfaces/{kind}/Info")
    assert error.line == line
    assert expected in str(error)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("my_interfaces/PersonInfo", "such as my_interfaces/srv/PersonInfo"),
        ("PersonInfo", "such as my_interfaces/srv/PersonInfo"),
        ("my_interfaces/srv/person_info", "starting with a capital letter, such as PersonInfo"),
        ("MyInterfaces/srv/PersonInfo", "'MyInterfaces' cannot name a package"),
        ("../srv/PersonInfo", "cannot name a package"),
    ],
)
def test_bad_type_names(name: str, expected: str) -> None:
    with pytest.raises(InterfaceDefinitionError) as caught:
        interfaces.define(name, "int64 a\n---\n")
    assert caught.value.line == 0
    assert expected in str(caught.value)


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: object) -> None:
    monkeypatch.setattr(environment, "run_dir", lambda: tmp_path)


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("geometry_msgs/Pont target", "There is no message geometry_msgs/Pont. Did you mean geometry_msgs/Point?"),
        ("Point target", "There is no message unknown_messages/Point. Did you mean "),
        ("no_such_msgs/Qqqq target", "There is no message no_such_msgs/Qqqq."),
        ("std_srvs/SetBool target", "There is no message std_srvs/SetBool."),
    ],
)
def test_unknown_messages(field: str, expected: str) -> None:
    with pytest.raises(InterfaceDefinitionError) as caught:
        interfaces.define("unknown_messages/srv/Info", f"int32 a\n---\n{field} # comment\n")
    assert (caught.value.line, caught.value.text) == (3, f"{field} # comment")
    assert expected in str(caught.value)


def test_messages_that_contain_themselves() -> None:
    with pytest.raises(InterfaceDefinitionError, match="cannot contain itself"):
        interfaces.define("endless_messages/msg/Info", "int32 a\nInfo inner\n")
    interfaces.define("endless_messages/msg/Outer", "int32 a\n")
    interfaces.define("endless_messages/msg/Inner", "Outer outer\n")
    with pytest.raises(InterfaceDefinitionError, match="cannot contain itself"):
        interfaces.define("endless_messages/msg/Outer", "Inner inner\n")


def test_packages_of_others_stay_as_they_are() -> None:
    with pytest.raises(InterfaceDefinitionError, match="'std_srvs' is installed and stays as it is"):
        interfaces.define("std_srvs/srv/SetBool", "int32 a\n---\n")
    with pytest.raises(InterfaceDefinitionError, match="'course_interfaces' comes with the course"):
        interfaces.define("course_interfaces/srv/Extra", "int32 a\n---\n")
    from example_interfaces.srv import AddTwoInts
    from std_srvs.srv import SetBool

    assert interfaces.define("example_interfaces/srv/AddTwoInts", "int64 a\nint64 b # b\n---\nint64 sum") is AddTwoInts
    assert interfaces.define("std_srvs/srv/SetBool", "bool data\n---\nbool success\nstring message\n") is SetBool


def test_an_indented_definition_keeps_its_line_numbers() -> None:
    interfaces.define(
        "indented_messages/msg/Info",
        """
        int32 a
        string b
        """,
    )
    with pytest.raises(InterfaceDefinitionError) as caught:
        interfaces.define(
            "indented_messages/msg/Info",
            """
            int32 a
            sting b
            """,
        )
    assert caught.value.line == 3

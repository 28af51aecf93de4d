"""Definitions are read as rosidl_adapter of ROS 2 Jazzy reads them."""

from __future__ import annotations

from ast import literal_eval
from pathlib import Path
from typing import Any

import pytest
from rosidl_adapter import parser as adapter
from rosidl_adapter.msg import convert_msg_to_idl
from rosidl_generator_py.generate_py_impl import constant_value_to_py, value_to_py
from rosidl_parser.definition import IdlLocator, Message
from rosidl_parser.parser import parse_idl_file

from course_kit import interfaces
from course_kit.interfaces import InterfaceDefinitionError
from course_kit.interfaces.definition import ActionDefinition, MessageDefinition, ServiceDefinition
from course_kit.interfaces.parser import PRIMITIVE_NAMES, parse_definition


def their_view(message: Any) -> Any:
    return (
        [(field.name, their_type(field.type), field.default_value) for field in message.fields],
        [(constant.name, PRIMITIVE_NAMES[constant.type], constant.value) for constant in message.constants],
    )


def their_type(kind: Any) -> tuple[str, str, int, int]:
    base = PRIMITIVE_NAMES[kind.type] if kind.is_primitive_type() else f"{kind.pkg_name}/msg/{kind.type}"
    container = "" if not kind.is_array else "array" if kind.is_fixed_size_array() else "sequence"
    return base, container, kind.array_size or 0, kind.string_upper_bound or 0


def our_view(message: MessageDefinition) -> Any:
    return (
        [(field.name, tuple(field.type), field.default) for field in message.fields],
        [(constant.name, constant.type.base, constant.value) for constant in message.constants],
    )


@pytest.mark.parametrize("package", interfaces.packages())
def test_every_definition_there_is(package: str) -> None:
    for full_name in interfaces.types(package):
        kind, name = full_name.split("/")[1:]
        text = interfaces.text_of(full_name)
        ours = parse_definition(full_name, text)
        if isinstance(ours, ServiceDefinition):
            theirs = adapter.parse_service_string(package, name, text)
            pairs = [(ours.request, theirs.request), (ours.response, theirs.response)]
        elif isinstance(ours, ActionDefinition):
            theirs = adapter.parse_action_string(package, name, text)
            pairs = [(ours.goal, theirs.goal), (ours.result, theirs.result), (ours.feedback, theirs.feedback)]
        else:
            assert kind == "msg"
            pairs = [(ours, adapter.parse_message_string(package, name, text))]
        for mine, other in pairs:
            assert our_view(mine) == their_view(other), full_name


LINES = [
    "int32 a -5 # comment",
    "int32\ta\t7",
    "byte a 0x10",
    "char[] a [1, 2]",
    "bool[3] a [true, 0, FALSE]",
    "float64 a inf",
    "string a plain text with blanks",
    'string a "it\'s"',
    'string a "say \\"no\\""',
    "wstring<=5[2] a ['é', \"ü\"]",
    "string[] a [\"a, b\", 'c', d e]",
    "int8 LOWEST=-128",
    'string UNIT = " m "',
    "string<=7[4] a",
    "geometry_msgs/Point[<=5] a",
]


@pytest.mark.parametrize("line", LINES)
def test_lines_with_all_there_is(line: str) -> None:
    ours = parse_definition("my_interfaces/msg/Info", f"\n# Comment\n{line}\n")
    assert isinstance(ours, MessageDefinition)
    assert our_view(ours) == their_view(adapter.parse_message_string("my_interfaces", "Info", f"{line}\n"))


ESCAPES = [
    r'string a "x\ty"',
    r'string a "x\\ty"',
    r"string a 'say \"so\"'",
    r"string A='x\ty'",
    r"string A=C:\\\\temp",
    r"string[] a ['x\\ny', '\x41']",
]


@pytest.mark.parametrize("line", ESCAPES)
def test_escapes_are_those_of_rosidl(line: str, tmp_path: Path) -> None:
    """rosidl writes IDL, reads that, and writes Python of it; what Python makes of that counts."""
    (tmp_path / "msg").mkdir()
    (tmp_path / "msg" / "Info.msg").write_text(f"{line}\n", encoding="utf-8")
    written = convert_msg_to_idl(tmp_path, "my_interfaces", Path("msg/Info.msg"), tmp_path)
    read = parse_idl_file(IdlLocator(tmp_path, written.relative_to(tmp_path)))
    (theirs,) = read.content.get_elements_of_type(Message)
    ours = parse_definition("my_interfaces/msg/Info", f"{line}\n")
    assert isinstance(ours, MessageDefinition)
    if theirs.constants:
        assert ours.constants[0].value == literal_eval(
            constant_value_to_py(theirs.constants[0].type, theirs.constants[0].value)
        )
    else:
        member = theirs.structure.members[0]
        default = value_to_py(member.type, member.get_annotation_value("default")["value"])
        assert ours.fields[0].default == literal_eval(default)


def test_an_escape_without_an_end() -> None:
    with pytest.raises(InterfaceDefinitionError, match=r"Expected an escape such as .* not \\x4\."):
        parse_definition("my_interfaces/msg/Info", 'string a "x\\x4"\n')


def test_windows_line_ends() -> None:
    assert parse_definition("my_interfaces/srv/Info", "int32 a\r\n---\r\nbool b\r\n") == parse_definition(
        "my_interfaces/srv/Info", "int32 a\n---\nbool b\n"
    )

"""What learners do with types of their own, beyond what compiled classes are compared in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.serialization import deserialize_message, serialize_message

from course_kit import interfaces
from course_kit.interfaces import InterfaceDefinitionError
from course_kit.interfaces.definition import TypeName
from course_kit.interfaces.library import Library

if TYPE_CHECKING:
    from pathlib import Path

PACKAGE = "own_interfaces"


def own(text: str, name: str = "Pt", **others: str) -> Any:
    """A message of a package that has some others."""
    texts = {**others, name: text}
    library = Library(lambda wanted: texts.get(wanted.name) if wanted.package == PACKAGE else None)
    built = library.get(TypeName(PACKAGE, "msg", name))
    assert built is not None
    return built.classes[name]


def test_values_without_names_are_told_where_they_belong() -> None:
    with pytest.raises(TypeError, match=r"^Pt takes its fields by name: write Pt\(x=1\.0, y=2\.0\)\.$"):
        own("float64 x\nfloat64 y\n")(1.0, 2.0)
    with pytest.raises(TypeError, match=r"Pt has no fields, so it takes no values: write Pt\(\)"):
        own("")(1.0)


def test_a_subclass_is_a_message() -> None:
    pt = own("float64 x\nfloat64[] more\n")

    class Longer(pt):  # type: ignore[misc]
        __module__ = "__main__"  # as in a notebook

        def length(self) -> float:
            return abs(self.x)

    longer = Longer(x=-2.0, more=[1.0])
    assert repr(longer) == "Longer(x=-2.0, more=[1.0])"
    assert longer.length() == 2.0
    assert deserialize_message(serialize_message(longer), Longer) == pt(x=-2.0, more=[1.0])


def test_wide_strings_in_lists_have_the_bounds_that_rosidl_gives_them() -> None:
    """rosidl_parser makes a `wstring<=3[]` a `wstring<=3[<=3]`; test_reference_build.py compares it with a real one."""
    cls = own("wstring<=3[] a\nwstring<=3[<=2] b\nstring<=3[] c\n")
    types = cls.get_fields_and_field_types()
    assert list(types.values()) == ["sequence<wstring<3>, 3>", "sequence<wstring<3>, 2>", "sequence<string<3>>"]
    message = cls(a=["äöü", "", "x"], b=["ab"], c=["abc"] * 5)
    assert deserialize_message(serialize_message(message), cls) == message
    with pytest.raises(AssertionError, match="with length <= 3 and each string value not longer than 3"):
        message.a = ["abcd"]


def test_bytes_that_are_no_such_message_are_told_in_words() -> None:
    with pytest.raises(rclpy_implementation.RMWError, match="are not a own_interfaces/msg/Pt as this program"):
        deserialize_message(b"\0\1\0\0\1", own("float64 x\n"))


def test_names_that_ros_has_too_are_ones_own_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "short_names" / "msg"
    folder.mkdir(parents=True)
    (folder / "Header.msg").write_text("int32 number\n")
    (folder / "Uses.msg").write_text("Header own\nstd_msgs/Header other\n")
    (folder / "Wrong.msg").write_text("int32 fine\nString text\n")
    (folder / "Far.msg").write_text("Known far\n")
    (folder / "Known.idl").write_text("module short_names { module msg { struct Known { long number; }; }; };\n")
    monkeypatch.setenv("COURSE_KIT_INTERFACE_PATH", str(tmp_path))
    uses = interfaces.get_type("short_names/msg/Uses")()
    assert uses.own.number == 0
    assert uses.other.frame_id == ""
    with pytest.raises(InterfaceDefinitionError, match=r"line 2: 'String text'\. .*did you mean string\?"):
        interfaces.get_type("short_names/msg/Wrong")
    with pytest.raises(InterfaceDefinitionError, match=r"short_names/Known exists only as IDL.*Known\.idl.*Known\.msg"):
        interfaces.get_type("short_names/msg/Far")
    with pytest.raises(InterfaceDefinitionError, match=r"did you mean std_msgs/Header\?"):
        own("Header header\n")

"""The native helper: more types than one copy has room for, and what people read where it cannot work."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message

from course_kit.interfaces import NativeHelperError, type_support
from course_kit.interfaces.definition import TypeName
from course_kit.interfaces.library import Library
from course_kit.interfaces.native import loader

SLOTS = 1024


def test_more_types_than_there_are_slots_for(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    fresh = loader.load_helper(copy_of(tmp_path, "fresh.so"))
    monkeypatch.setattr(type_support, "_helper", lambda: fresh)
    cls = Library(lambda _: "int64 a\nstring b\n").get(TypeName("many_messages", "msg", "Info")).classes["Info"]
    used = {fresh.live_create_function(type_support._new_type(cls)) for _ in range(SLOTS)}
    assert len(used) == SLOTS
    with pytest.raises(NativeHelperError, match="more messages than it has room for: start Python again"):
        type_support._new_type(cls)


def copy_of(folder: Path, name: str) -> Path:
    """The helper with a table of types of its own."""
    return Path(shutil.copy(loader.LIBRARY, folder / name))


def test_a_python_whose_lists_are_laid_out_differently(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """What the helper would read from a list's memory is packed in Python then, to the same bytes."""
    text = "bool[] flags\nbyte[] octets\nbyte[3] few\n"
    values = {"flags": [True, False, True], "octets": [b"a", b"\xff"], "few": [b"x", b"\x00", b"y"]}

    def message(package: str) -> Any:
        built = Library(lambda _: text).get(TypeName(package, "msg", "Packed"))
        type(built.classes["Packed"]).__import_type_support__()
        return built.classes["Packed"](**values)

    usual = message("usual_python")
    assert 0 not in loader._probe_python()
    assert loader.load_helper(copy_of(tmp_path, "one.so")).live_octets(values["octets"]) == b"a\xff"
    with monkeypatch.context() as another:
        another.setattr(sys, "implementation", SimpleNamespace(name="another"))
        assert loader._probe_python() == (0, 0)
    monkeypatch.setattr(loader, "_probe_python", lambda: (0, 0))
    copy = loader.load_helper(copy_of(tmp_path, "other.so"))
    assert copy.live_octets(values["octets"]) is None
    assert copy.live_booleans(values["flags"]) is None
    monkeypatch.setattr(type_support, "_helper", lambda: copy)
    unusual = message("another_python")
    wire = serialize_message(unusual)
    assert wire == serialize_message(usual)
    assert deserialize_message(wire, type(unusual)) == unusual


def test_the_helper_is_missing(tmp_path: Path) -> None:
    with pytest.raises(NativeHelperError, match=r"could not be loaded .*cannot open.* install it again"):
        loader.load_helper(tmp_path / "_helper.so")


def test_a_helper_of_another_version(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    refused = r"compiled from another version of the course\. Run \./course lab .* start Python again"
    untold = tmp_path / "untold.so"  # one that does not tell what it was made from
    untold.write_bytes(loader.LIBRARY.read_bytes().replace(b"live_source", b"live_s0urce"))
    with pytest.raises(NativeHelperError, match=refused):
        loader.load_helper(untold)
    newer = tmp_path / "helper.c"
    newer.write_bytes(loader.SOURCE.read_bytes() + b"/* changed */\n")
    monkeypatch.setattr(loader, "SOURCE", newer)
    with pytest.raises(NativeHelperError, match=refused):
        loader.load_helper()


def test_another_middleware(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    with pytest.raises(NativeHelperError, match="RMW_IMPLEMENTATION is set to 'rmw_cyclonedds_cpp', but"):
        loader.load_helper()
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp")
    loader.load_helper()

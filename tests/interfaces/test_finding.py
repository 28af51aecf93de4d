"""Live interfaces are there in every Python of the environment, and what is installed comes first."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from course_kit import environment, interfaces
from course_kit.interfaces import finder

REPOSITORY = Path(__file__).parents[2]


@pytest.fixture(autouse=True)
def own_folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.setattr(environment, "run_dir", lambda: tmp_path)
    return tmp_path / "interfaces"


def run(program: str, **changes: str) -> str:
    search = os.pathsep.join([str(REPOSITORY), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)],
        env=environment.child_environment(PYTHONPATH=search, **changes),
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_program_that_knows_nothing_of_the_course() -> None:
    printed = run("""
        from course_interfaces.action import MoveRobot
        from course_interfaces.srv import ConvertTemperature
        from example_interfaces.action import Fibonacci
        from example_interfaces.msg import *
        from example_interfaces.srv import AddTwoInts, SetBool, Trigger
        import example_interfaces.msg

        print(AddTwoInts.Request(a=1), Fibonacci.Goal(order=2), ConvertTemperature.Request.CELSIUS)
        print(MoveRobot.Feedback(progress=0.5).progress, WString(data="é"), len(example_interfaces.msg.__all__))
        """)
    assert printed == (
        "example_interfaces.srv.AddTwoInts_Request(a=1, b=0) "
        "example_interfaces.action.Fibonacci_Goal(order=2) celsius\n"
        "0.5 example_interfaces.msg.WString(data='é') 29\n"
    )


HEAVY = ("typing", "importlib.abc", "dataclasses", "inspect", "ctypes", "numpy", "rosidl_parser", "pathlib", "re")


def test_the_finder_costs_nothing_at_the_start_of_python() -> None:
    printed = run(f"""
        import sys
        for name in {HEAVY!r}:
            sys.modules.pop(name, None)
        from course_kit.interfaces import finder
        finder.install()
        finder.install()
        print([name for name in {HEAVY!r} if name in sys.modules])
        names = [getattr(each, "__name__", type(each).__name__) for each in sys.meta_path]
        print(names.count("LiveFinder"), names.index("LiveFinder") > names.index("PackagesFirst"))
        """)
    assert printed == "[]\n1 True\n"


def test_an_installed_package_wins(tmp_path: Path) -> None:
    package = tmp_path / "site" / "example_interfaces" / "srv"
    package.mkdir(parents=True)
    (package.parent / "__init__.py").write_text("")
    (package / "__init__.py").write_text("AddTwoInts = 'the installed one'\n")
    program = "from example_interfaces.srv import AddTwoInts; print(AddTwoInts)"
    assert run(f"import sys; sys.path.insert(0, {str(tmp_path / 'site')!r})\n{program}") == "the installed one\n"


def test_a_saved_definition_is_found_by_other_processes(own_folder: Path) -> None:
    interfaces.define("saved_interfaces/srv/PersonInfo", "string name\n---\nbool success\n")
    assert [path.name for path in (own_folder / "saved_interfaces" / "srv").iterdir()] == ["PersonInfo.srv"]
    program = "from saved_interfaces.srv import PersonInfo; print(PersonInfo.Request(name='Ada'))"
    shown = "saved_interfaces.srv.PersonInfo_Request(name='Ada')\n"
    assert run(program, COURSE_KIT_INTERFACE_PATH=f"/no such folder{os.pathsep}{own_folder}") == shown


def test_modules_are_laid_out_as_rosidl_lays_them_out() -> None:
    from example_interfaces.action import Fibonacci
    from example_interfaces.action._fibonacci import Fibonacci_Goal, Metaclass_Fibonacci_Goal

    assert Fibonacci.Goal is Fibonacci_Goal
    assert type(Fibonacci_Goal) is Metaclass_Fibonacci_Goal
    from example_interfaces.srv import AddTwoInts, AddTwoInts_Request

    assert AddTwoInts.Request is AddTwoInts_Request
    import example_interfaces.srv

    assert {"AddTwoInts", "SetBool", "Trigger"} <= set(dir(example_interfaces.srv))
    assert finder.is_live(example_interfaces.srv)


@pytest.mark.parametrize(
    ("wrong", "right"),
    [
        ("std_srvs/srv/SetBol", "std_srvs/srv/SetBool"),
        ("std_srvs/msg/SetBool", "std_srvs/srv/SetBool"),
        ("geometry_msgs/msg/point", "geometry_msgs/msg/Point"),
        ("AddTwoInts", "example_interfaces/srv/AddTwoInts"),
    ],
)
def test_the_nearest_right_name(wrong: str, right: str) -> None:
    with pytest.raises(interfaces.InterfaceNotFoundError) as caught:
        interfaces.get_type(wrong)
    assert caught.value.nearest == right
    assert f"Did you mean {right!r}?" in str(caught.value)


@pytest.mark.parametrize("nonsense", ["", "a/b/c/d", "zzzz/srv/Qqqqqqqq"])
def test_nonsense_names(nonsense: str) -> None:
    with pytest.raises(interfaces.InterfaceNotFoundError) as caught:
        interfaces.get_type(nonsense)
    assert repr(nonsense) in str(caught.value)


def test_threads_that_use_a_type_first_at_once() -> None:
    printed = run("""
        import sys
        import threading

        sys.setswitchinterval(1e-6)
        together = threading.Barrier(8)
        found = []

        def use() -> None:
            together.wait()
            from course_interfaces.action import MoveRobot
            type(MoveRobot).__import_type_support__()
            found.append((MoveRobot, type(MoveRobot)._TYPE_SUPPORT, type(MoveRobot.Goal)._CREATE_ROS_MESSAGE))

        threads = [threading.Thread(target=use) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        print(len(found), len({id(part) for parts in found for part in parts}))
        """)
    assert printed == "8 3\n"


def test_without_ros_2_one_sentence_says_what_to_do() -> None:
    printed = run("""
        import sys
        sys.modules["rosidl_parser"] = None
        try:
            from example_interfaces.srv import AddTwoInts
        except ImportError as error:
            print(error)
        """)
    assert printed.startswith("The course's interfaces need ROS 2 Jazzy")


def in_folder(folder: Path, package: str, file: str, text: bytes) -> Path:
    path = folder / package / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(text)
    return path


def test_a_folder_beside_a_program_does_not_hide_its_interfaces(tmp_path: Path) -> None:
    """`python -c` and `python program.py` look beside themselves first, where the folder is a namespace package."""
    in_folder(tmp_path, "door_interfaces", "srv/Open.srv", b"int32 width\n---\nbool done\n")
    in_folder(tmp_path, "plain_folder", "data.txt", b"")
    here = f"import os, sys; os.chdir({str(tmp_path)!r}); sys.path.insert(0, '')\n"
    program = "from door_interfaces.srv import Open; import plain_folder; print(Open.Request(width=2), plain_folder)"
    printed = run(here + program, COURSE_KIT_INTERFACE_PATH=str(tmp_path))
    assert "Open_Request(width=2) <module 'plain_folder' (" in printed
    in_folder(tmp_path, "door_interfaces", "__init__.py", b"made = 'by its author'")
    program = "import door_interfaces; print(door_interfaces.made)"
    assert "by its author" in run(here + program, COURSE_KIT_INTERFACE_PATH=str(tmp_path))


def test_a_definition_that_is_not_utf8_is_named_with_its_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = "bool on\nfloat64 value # °C\n---\n".encode("latin-1")
    path = in_folder(tmp_path, "heat_interfaces", "srv/Heat.srv", text)
    monkeypatch.setenv("COURSE_KIT_INTERFACE_PATH", str(tmp_path))
    for ask in (interfaces.text_of, interfaces.get_type):
        with pytest.raises(interfaces.InterfaceDefinitionError, match=r"^heat_interfaces/srv/Heat, line 2: ") as caught:
            ask("heat_interfaces/srv/Heat")
        assert str(caught.value).endswith(f"Expected UTF-8, and byte 0xb0 is none: save {path} with this encoding.")


@pytest.mark.parametrize("name", ["robot_state", "Robot_State"])
def test_a_definition_whose_file_has_a_name_that_no_type_can_have(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    in_folder(tmp_path, "box_interfaces", f"msg/{name}.msg", b"int32 a\n")
    monkeypatch.setenv("COURSE_KIT_INTERFACE_PATH", str(tmp_path))
    for ask in (interfaces.text_of, interfaces.get_type, imported):
        with pytest.raises(
            interfaces.InterfaceDefinitionError, match=f"'{name}' cannot name an interface: .*RobotState"
        ):
            ask(f"box_interfaces/msg/{name}")
    assert interfaces.types("box_interfaces") == []


def imported(name: str) -> object:
    return getattr(importlib.import_module("box_interfaces.msg"), name.rpartition("/")[2])

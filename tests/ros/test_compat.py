"""A name of rclpy, rosidl, IPython or nbval that is missing costs one feature and one sentence, and never the lab."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment
from course_kit.ros import compat
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from course_kit.lab.runtime.core import Lab

REPOSITORY = Path(__file__).resolve().parent.parent.parent
NAMES = sorted({name for feature in compat.ALL for name in feature.names})


def features_of(name: str, among: tuple[compat.Feature, ...] = compat.ALL) -> list[compat.Feature]:
    return [feature for feature in among if name in feature.names]


@pytest.fixture(scope="module")
def lab_without() -> Iterator[Callable[[str], dict[str, Any]]]:
    """What came of using the lab without a name; with all of them for an empty one."""
    process = subprocess.Popen(
        [sys.executable, "-m", "tests.ros.lab_without"],
        cwd=REPOSITORY, env=environment.child_environment(), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert process.stdin is not None
    assert process.stdout is not None
    asking, answers = process.stdin, process.stdout

    @cache
    def ask(name: str) -> dict[str, Any]:
        asking.write(name + "\n")
        asking.flush()
        outcome: dict[str, Any] = json.loads(answers.readline())
        return outcome

    with process:
        yield ask
        asking.close()


def test_with_all_names_nothing_is_off(lab_without: Callable[[str], dict[str, Any]]) -> None:
    outcome = lab_without("")
    assert outcome["problem"] == ""
    assert outcome["said"] == ""
    assert outcome["doctor"] == "everything that the course uses is present"
    assert (outcome["sums"], outcome["sequence"], outcome["words"]) == ([5, 5, 5], [0, 1, 1, 2, 3], ["hello"])
    assert "add_two_ints" in outcome["diagram"]
    assert "fibonacci" in outcome["diagram"]


@pytest.mark.parametrize("name", sorted({feature.names[0] for feature in compat.ALL}))
def test_without_a_name_the_lab_works_and_one_sentence_says_what_is_off(
    name: str, lab_without: Callable[[str], dict[str, Any]]
) -> None:
    outcome = lab_without(name)
    assert outcome["problem"] == ""
    assert (outcome["sums"], outcome["sequence"], outcome["words"]) == ([5, 5, 5], [0, 1, 1, 2, 3], ["hello"])
    shown = name.replace(":", ".")
    sentences = [line for line in outcome["said"].splitlines() if shown in line]
    assert [sentence.partition(":")[0] for sentence in sentences] == [
        feature.lost for feature in features_of(name, compat.OF_THE_LAB)
    ]
    assert all(sentence.endswith("; everything else works.") for sentence in sentences)
    assert outcome["said"].splitlines() == sentences
    for feature in features_of(name):
        assert feature.lost in outcome["doctor"]
    assert shown in outcome["doctor"]


def test_without_the_recording_of_goals_messages_are_recorded(lab_without: Callable[[str], dict[str, Any]]) -> None:
    diagram = lab_without(compat.GOAL_RECORDING.names[0])["diagram"]
    assert "add_two_ints" in diagram
    assert "fibonacci" not in diagram


def test_the_lab_can_be_imported_without_the_check() -> None:
    program = (
        "import sys, course_kit.lab; print([name for name in sys.modules if name.startswith('course_kit.ros.compat')])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100, check=True)
    assert done.stdout == "[]\n"


PREPARE = """
import sys
sys.path.insert(0, {repository!r})
import rclpy.action, rclpy.impl.rcutils_logger
from tests.ros.renaming import take_away
take_away({name!r})
from course_kit import lab
"""
USE = """
from std_srvs.srv import Trigger
from rclpy.node import Node

class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.create_service(Trigger, "ask", self.answer)

    def answer(self, request, response):
        self.get_logger().info("asked")
        return response

lab.start(Server)
print(lab.call_blocking("/ask", Trigger))
"""


def test_a_notebook_works_without_what_its_log_lines_need_and_says_so_once(domain: int, tmp_path: Path) -> None:
    assert domain
    name = compat.LOG_LINES.names[0]
    with Kernel(cwd=tmp_path) as kernel:
        assert kernel.run(PREPARE.format(repository=str(REPOSITORY), name=name)).ok
        first, second = kernel.run(USE), kernel.run(USE)
    for shown in (first, second):
        assert shown.ok, shown.error
        assert "Trigger_Response" in shown.stdout
        assert "[server]: asked" not in shown.stdout
    assert first.stderr.count(compat.LOG_LINES.lost) == 1
    assert compat.LOG_LINES.lost not in second.stderr


def test_a_program_whose_rclpy_cannot_be_recorded_runs_and_the_lab_says_so_once(
    own_lab: Lab, capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = compat.RECORDING.names[0]
    (tmp_path / "sitecustomize.py").write_text(
        "import sys\n"
        "if 'course_kit.lab.scripts.child_main' in sys.orig_argv:\n"
        f"    sys.path.insert(0, {str(REPOSITORY)!r})\n"
        "    import rclpy.action\n"
        "    from tests.ros.renaming import take_away\n"
        f"    take_away({name!r})\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    for number in range(2):
        own_lab.scripts.run(f"program{number}", f"import rclpy\nrclpy.init()\nprint('ran {number}')\n", (), "wait")
    told = capsys.readouterr()
    assert "ran 0" in told.out
    assert "ran 1" in told.out
    assert told.err.count(compat.RECORDING.lost) == 1


# Of Python itself, and of ipywidgets; and of classes of the kit's own that others inherit from.
OTHERS = {
    "_Environ", "_SubParsersAction", "_actions", "_asdict", "_choices_actions", "_clear", "_current_frames", "_exit",
    "_fields", "_format_action_invocation", "_replace", "_repr_mimebundle_", "_run_exitfuncs", "_shutdown",
    "_take_signals", "_base_executable", "_live", "_register_atexit", "_grading_mode", "_getframe",
}  # fmt: skip


def private_names(text: str) -> Iterator[str]:
    """The private attributes a file uses of others, named in code or in getattr() and Patches.set()."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Attribute):
            if not (isinstance(node.value, ast.Name) and node.value.id in {"self", "cls"}):
                yield node.attr
        elif isinstance(node, ast.Call) and _called(node) in {"getattr", "set", "hasattr"} and len(node.args) > 1:
            yield str(getattr(node.args[1], "value", ""))


def _called(call: ast.Call) -> str:
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


def test_every_private_name_that_the_kit_uses_is_in_the_table() -> None:
    listed = {name.replace(":", ".").rpartition(".")[2] for name in NAMES} | OTHERS
    unlisted = {
        f"{path.relative_to(REPOSITORY)}: {name}"
        for path in (REPOSITORY / "course_kit").rglob("*.py")
        for name in private_names(path.read_text())
        if re.fullmatch(r"_[a-zA-Z]\w*|__import_type_support__", name) and name not in listed
    }
    assert unlisted == set()


def test_every_name_of_the_c_library_that_the_kit_uses_is_in_the_table() -> None:
    listed = {name.rpartition(".")[2] for name in NAMES}
    used = {
        match["name"]
        for path in (REPOSITORY / "course_kit").rglob("*.py")
        if path.parent.name != "environment"  # asks a C library by ctypes, before rclpy is loaded
        for match in re.finditer(r"\b(?:rclpy_implementation|_rclpy|_rcl|rcl)\.(?P<name>\w+)", path.read_text())
    }
    assert {"WaitSet", "GuardCondition"} <= used
    assert used - listed == set()

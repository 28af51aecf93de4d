"""A name of rclpy, rosidl, IPython or nbval that is missing costs one feature and one sentence, and never the lab."""

from __future__ import annotations

import importlib
import json
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment
from course_kit.ros import compat, compat_names

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

REPOSITORY = Path(__file__).resolve().parent.parent.parent
NAMES = sorted({name for feature in compat_names.ALL for name in feature.names})


def features_of(name: str, among: tuple[compat_names.Feature, ...] = compat_names.ALL) -> list[compat_names.Feature]:
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
    assert outcome["doctor"] == "everything that the course uses is there"
    assert (outcome["sums"], outcome["sequence"], outcome["words"]) == ([5, 5, 5], [0, 1, 1, 2, 3], ["hello"])
    assert "add_two_ints" in outcome["diagram"]
    assert "fibonacci" in outcome["diagram"]


@pytest.mark.parametrize("name", NAMES)
def test_without_a_name_the_lab_works_and_one_sentence_says_what_is_off(
    name: str, lab_without: Callable[[str], dict[str, Any]]
) -> None:
    outcome = lab_without(name)
    assert outcome["problem"] == ""
    assert (outcome["sums"], outcome["sequence"], outcome["words"]) == ([5, 5, 5], [0, 1, 1, 2, 3], ["hello"])
    shown = name.replace(":", ".")
    sentences = [line for line in outcome["said"].splitlines() if shown in line]
    assert [sentence.partition(":")[0] for sentence in sentences] == [
        feature.lost for feature in features_of(name, compat_names.OF_THE_LAB)
    ]
    assert all(sentence.endswith("; everything else works.") for sentence in sentences)
    assert outcome["said"].splitlines() == sentences
    for feature in features_of(name):
        assert feature.lost in outcome["doctor"]
    assert shown in outcome["doctor"]


@pytest.mark.parametrize("name", compat_names.RECORDING.names)
def test_without_recording_the_diagram_is_there_and_empty_of_messages(
    name: str, lab_without: Callable[[str], dict[str, Any]]
) -> None:
    assert "add_two_ints" not in lab_without(name)["diagram"]


@pytest.mark.parametrize("name", compat_names.GOAL_RECORDING.names)
def test_without_the_recording_of_goals_messages_are_recorded(
    name: str, lab_without: Callable[[str], dict[str, Any]]
) -> None:
    diagram = lab_without(name)["diagram"]
    assert "add_two_ints" in diagram
    assert "fibonacci" not in diagram


def test_every_user_of_a_name_is_a_module_of_the_kit() -> None:
    users = {user for feature in compat_names.ALL for user in feature.users}
    assert [user for user in users if not (REPOSITORY / "course_kit" / user).is_file()] == []


def test_the_check_loads_nothing() -> None:
    importlib.import_module("rclpy.action")
    compat.check()
    before = set(sys.modules)
    compat.check()
    assert set(sys.modules) == before


def test_the_lab_can_be_imported_without_the_check() -> None:
    program = "import sys, course_kit.lab; print([name for name in sys.modules if name.startswith('course_kit.ros.')])"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=100, check=True)
    assert done.stdout == "[]\n"

"""The authoring guide is as true as the kit: its tables, its commands, and the programs and tables it shows."""

from __future__ import annotations

import re
import shlex
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from course_kit.authoring import new_exercise
from course_kit.cli import main as cli
from course_kit.grading.checks.declared import kinds
from course_kit.grading.checks.declared.evaluation import CONSTANTS, FUNCTIONS, OF_ANYTHING

if TYPE_CHECKING:
    from pathlib import Path

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

GUIDE = environment.PACKAGE / "authoring" / "AUTHORING.md"
TEXT = GUIDE.read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


def rows() -> dict[str, set[str]]:
    """The keys that the table of kinds names, by kind."""
    found = {}
    for line in TEXT.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 3 and (kind := cells[0].strip("`")) in kinds.KINDS:
            found[kind] = set(re.findall(r"`(\w+)`", cells[2]))
    return found


def test_every_kind_of_check_is_in_the_guide_with_its_keys() -> None:
    told = rows()
    assert set(told) == set(kinds.KINDS)
    sent = {"requests", "messages", "goals"}
    for name, kind in kinds.KINDS.items():
        keys = set(kind.keys) - {"request"}  # which only helps `offered`
        assert keys <= told[name], name
        assert told[name] <= keys | (sent if name == "parameter_acts" else set()), name


def test_what_expressions_know_is_in_the_guide() -> None:
    for name in (*FUNCTIONS, *OF_ANYTHING, *(set(CONSTANTS) - {"true", "false"})):
        assert re.search(rf"\b{name}\b", TEXT), name


@pytest.mark.parametrize("number", range(len(blocks("toml"))))
def test_each_piece_of_toml_can_be_read(number: int) -> None:
    assert tomllib.loads(blocks("toml")[number])


def test_its_commands_are_those_there_are() -> None:
    parser = cli.build_parser()
    verbs = re.search(r"\{([\w,]+)\}", parser.format_usage())
    known = set(re.findall(r"^    (\w+)", parser.format_help(), re.MULTILINE))
    named = [shlex.split(line)[1] for line in TEXT.splitlines() if line.startswith("./course ")]
    assert len(named) > 6
    assert set(named) <= known | (set(verbs[1].split(",")) if verbs else set())


def test_the_files_it_lists_are_made(tmp_path: Path) -> None:
    made = new_exercise.create("dead_band", "topic", tmp_path).folder
    for name in ("exercise.toml", "dead_band.py", "dead_band.ipynb", "solution/dead_band.py", "proof/slips.toml"):
        assert f"`{name}`" in TEXT or name.rpartition("/")[2] in TEXT
        assert (made / name).is_file()


def test_its_check_in_python_is_one(tmp_path: Path) -> None:
    """Really graded: a filter that keeps the sign passes it, one that loses it does not."""
    made = new_exercise.create("dead_band", "topic", tmp_path).folder
    toml = made / "exercise.toml"
    toml.write_text(EXERCISE)
    (code,) = blocks("python")
    (made / "checks.py").write_text(code)
    program = made / "solution" / "dead_band.py"
    program.write_text(FILTER)
    right = grading.grade("dead_band", program, exercises=tmp_path)
    assert (right.score, right.max_score) == (2.0, 2.0), right
    program.write_text(FILTER.replace("publish(message)", "publish(Twist(linear=Vector3(x=abs(message.linear.x))))"))
    wrong = grading.grade("dead_band", program, exercises=tmp_path)
    assert [check.id for check in wrong.checks if check.status == "failed"] == ["symmetric"]


EXERCISE = """
format_version = 1
id = "dead_band"
title = "A filter"
order = 9
points = 2.0
pass_mark = 2.0
class_name = "DeadBand"
starter = "dead_band.py"
notebook = "dead_band.ipynb"
solution = "solution/dead_band.py"
grader = "checks.py"
endpoints = [
  { kind = "subscription", name = "/cmd_vel_in", type = "geometry_msgs/msg/Twist" },
  { kind = "publisher", name = "/cmd_vel", type = "geometry_msgs/msg/Twist" },
]
sentences = [{ id = "topics", text = "Two topics." }, { id = "symmetric", text = "The sign is kept." }]
checks = [{ id = "offered", kind = "offered", title = "Topics", points = 1.0, proves = ["topics"] }]
hints = [{ for = ["offered", "symmetric"], text = "Look at the sign." }]
"""
FILTER = """
import rclpy
from geometry_msgs.msg import Twist, Vector3

rclpy.init()
node = rclpy.create_node("dead_band")
publisher = node.create_publisher(Twist, "cmd_vel", 10)
node.create_subscription(Twist, "cmd_vel_in", lambda message: publisher.publish(message), 10)
rclpy.spin(node)
"""

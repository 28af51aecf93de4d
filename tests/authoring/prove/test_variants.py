"""Right programs made from a solution: what is different, and where nothing is."""

from __future__ import annotations

import ast

import pytest

from course_kit import environment
from course_kit.authoring.prove import variants
from tests.authoring.prove.test_mutants import NODE


def of(source: str) -> dict[str, str]:
    return {one.name: one.source for one in variants.of(source)}


@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("an executor with 8 threads", "MultiThreadedExecutor(num_threads=8)"),
        ("reentrant callback groups", "self.halve, 10, callback_group=rclpy.callback_groups.ReentrantCallbackGroup())"),
        ("asynchronous callbacks", "async def halve(self, message):"),
        ("a little slower in each callback", 'Publish half."""\n        time.sleep(0.005)'),
        (
            "endpoints made in another order",
            """self.create_service(Float64, "serve", self.serve)
        self.create_subscription(Float64, "into", self.halve, 10)
        self.out = self.create_publisher(Float64, "out", 10)""",
        ),
    ],
)
def test_what_is_different(name: str, part: str) -> None:
    assert part in of(NODE)[name]


def test_callbacks_that_rclpy_does_not_await_stay_as_they_are() -> None:
    assert "async def judge" not in of(NODE)["asynchronous callbacks"]
    called = NODE.replace(
        "    def judge(self, parameters):\n        return True",
        "    def judge(self, parameters):\n        self.halve(1)",
    )
    assert "async def halve" not in of(called)["asynchronous callbacks"]


def test_without_main_and_with_one() -> None:
    alone = of(NODE)["only the class, without main"]
    names = [node.name for node in ast.parse(alone).body if isinstance(node, (ast.ClassDef, ast.FunctionDef))]
    assert names == ["Half"]
    assert "main()" in of(alone)["with a main"]
    assert "only the class, without main" not in of(alone)
    must_start = [one.name for one in variants.of(NODE, own_start=True)]
    assert must_start == [name for name in of(NODE) if name != "only the class, without main"]


def test_one_thread_is_no_right_variant_of_several() -> None:
    assert not any("SingleThreaded" in text for text in of(NODE).values())
    spinning = "import rclpy\n\n\ndef main():\n    rclpy.spin(node)\n"
    assert (
        "rclpy.spin(node, rclpy.executors.SingleThreadedExecutor())"
        in of(spinning)["spins on a SingleThreadedExecutor()"]
    )


def test_answers() -> None:
    found = of('answers = {\n    "a": ("topic", "why"),\n    "b": ("action", "so"),\n}\n')
    assert found["entries in another order"] == 'answers = {"b": ("action", "so"), "a": ("topic", "why")}\n'
    assert found["made by a function"].startswith("def made():\n    return {")


@pytest.mark.parametrize("name", ["temperature_service", "move_robot", "robot_parameters", "pattern_choice"])
def test_each_solution_has_some_and_none_is_the_solution(name: str) -> None:
    root = environment.checkout()
    assert root is not None
    source = (root / "solutions" / name / f"{name}.py").read_text()
    found = variants.of(source)
    assert len(found) >= 2
    meanings = {ast.unparse(ast.parse(one.source)) for one in found}
    assert len(meanings) == len(found)
    assert ast.unparse(ast.parse(source)) not in meanings

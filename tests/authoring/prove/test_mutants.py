"""The mistakes that are made in a solution: each kind on a few lines, each once, under names that stay."""

from __future__ import annotations

import ast
from functools import cache

import pytest

from course_kit import environment
from course_kit.authoring.prove import mutants
from course_kit.authoring.prove.program import ParsedProgram, parsed

NODE = '''"""A node."""

import rclpy
from rclpy.node import Node
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Float64


class Half(Node):
    """Halves."""

    def __init__(self):
        super().__init__("half")
        self.out = self.create_publisher(Float64, "out", 10)
        self.create_subscription(Float64, "into", self.halve, 10)
        self.create_service(Float64, "serve", self.serve)
        self.add_on_set_parameters_callback(self.judge)
        self.declare_parameter("factor", 0.5)

    def halve(self, message):
        """Publish half."""
        self.get_logger().info("halving")
        factor = self.get_parameter("factor").value
        self.out.publish(Float64(data=message.data * factor))

    def serve(self, request, response):
        return response

    def judge(self, parameters):
        return True


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Half())
    executor.spin()


if __name__ == "__main__":
    main()
'''

ACTION = """
class Drive:
    def __init__(self):
        self.server = ActionServer(self, Move, "move", execute_callback=self.execute, goal_callback=self.decide)

    def decide(self, goal):
        return GoalResponse.ACCEPT

    def execute(self, goal_handle) -> Move.Result:
        while self.far():
            goal_handle.publish_feedback(Move.Feedback())
        goal_handle.succeed()
        return Move.Result(done=True)
"""


@cache
def made(source: str) -> tuple[mutants.Mutant, ...]:
    return tuple(mutants.of(source))


def changed(source: str, operator: str) -> list[str]:
    """What stands in place of a line, for each mutant of an operator."""
    return [one.after for one in made(source) if one.operator == operator]


@pytest.mark.parametrize(
    ("source", "operator", "wanted"),
    [
        ("a = b + c", "another operator", ["a = b - c"]),
        ("a = b + c", "operand forgotten", ["a = b", "a = c"]),
        ("a = (b - c) * d", "another operator", ["a = (b - c) / d", "a = (b + c) * d"]),
        ("a = b * c / d", "operand forgotten", ["a = b * c", "a = d", "a = b / d", "a = c / d"]),
        ("a = -b", "sign or not forgotten", ["a = b"]),
        ("a = b and c", "and for or", ["a = b or c"]),
        ("a = b and c", "condition forgotten", ["a = c", "a = b"]),
        ("a = b < c", "edge", ["a = b <= c"]),
        ("a = 0 <= b < c", "condition forgotten", ["a = 0 <= b", "a = b < c"]),
        ("a = b == c", "comparison reversed", ["a = b != c"]),
        ("a = 2", "another number", ["a = 3", "a = 1"]),
        ("a = 2", "another sign", ["a = -2"]),
        ("a = 2", "zero", ["a = 0"]),
        ("a = -1.5", "another number", ["a = -0.5", "a = -2.5"]),
        ("a = -1.5", "another sign", ["a = 1.5"]),
        ("a = 2.0", "number slightly off", ["a = 2.002", "a = 1.998"]),
        ("a = 'b'", "another text", ["a = 'b_x'"]),
        ("a = 'b'", "empty text", ["a = ''"]),
        ("a = True", "true for false", ["a = False"]),
        ("a = f'{b}: {c} m'", "value left out of a text", ["a = f': {c} m'", "a = f'{b}:  m'"]),
        ("for a in (b, c):\n    d(a)", "element left out", ["for a in (c,):", "for a in (b,):"]),
        ("a = b.x", "another field", ["a = b.y", "a = b.z"]),
        ("a = min(b, c)", "another function", ["a = max(b, c)"]),
        ("a = b(c, d)", "arguments swapped", ["a = b(d, c)"]),
        ("a = b(c, d=e)", "keyword left out", ["a = b(c)"]),
        ("a = b(c, d)", "argument left out", ["a = b(c)"]),
        ("a = b(c)", "function left out", ["a = c"]),
        ("b.c = d", "assignment left out", ["pass"]),
        ("if b:\n    c = 1", "condition negated", ["if not b:"]),
        ("if b:\n    c = 1", "condition always true", ["if True:"]),
        ("if b:\n    c = 1", "condition never true", ["if False:"]),
        ("for a in b:\n    c(a)", "loop run once", ["break"]),
        ("def a():\n    return b", "return left out", ["b"]),
        ("def a():\n    return b", "another value returned", ["return None"]),
        ("def a() -> M.Result:\n    return b", "another value returned", ["return None", "return M.Result()"]),
        ("a.b()", "call left out", ["pass"]),
        (
            "n.declare_parameter('a', 3.0)",
            "parameter's type",
            ["n.declare_parameter('a', '3.0')", "n.declare_parameter('a', 3)"],
        ),
        (
            "n.declare_parameter('a', True)",
            "parameter's type",
            ["n.declare_parameter('a', 'True')", "n.declare_parameter('a', 1)"],
        ),
        (NODE, "published twice", ["self.out.publish(Float64(data=message.data * factor))"]),
        (NODE, "one thread", ["executor = rclpy.executors.SingleThreadedExecutor()"]),
        (NODE, "one spin", ["executor.spin_once()"]),
        (NODE, "type alike", ["from std_msgs.msg import Float32 as Float64"]),
    ],
)
def test_each_kind_of_mistake(source: str, operator: str, wanted: list[str]) -> None:
    assert changed(source, operator) == wanted


def only(source: str, operator: str, *parts: str) -> mutants.Mutant:
    """The one mutant of an operator whose text has all these parts."""
    found = [one for one in made(source) if one.operator == operator and all(part in one.source for part in parts)]
    assert len(found) == 1, [one.key for one in found]
    return found[0]


def test_names_and_services_of_endpoints() -> None:
    assert only(NODE, "endpoint's name", '"into"', "'outs'")
    assert only(NODE, "endpoint's name", "'~/into'")
    best_effort = only(NODE, "quality of service", "self.halve, rclpy.qos.QoSProfile(depth=10, reliability=")
    assert "BEST_EFFORT" in best_effort.after
    assert only(NODE, "quality of service", "self.serve, qos_profile=rclpy.qos.QoSProfile", "BEST_EFFORT")
    assert only(NODE, "endpoint destroyed", "self.destroy_subscription(self.create_subscription(")
    assert only(NODE, "another type", 'create_publisher(__import__("std_msgs.msg"')


def test_callbacks() -> None:
    assert only(NODE, "callback does nothing", '"into", lambda *given: None, 10')
    assert only(NODE, "another callback", '"into", self.serve, 10')
    assert only(NODE, "exception in a callback", 'Publish half."""\n        raise RuntimeError')
    assert only(NODE, "exception in a callback", 'hasattr(self, "called_halve")')
    blocking = only(NODE, "blocking callback", "import time\n", 'Publish half."""\n        time.sleep(')
    assert [line[0] for line in blocking.diff] == ["+", "+"]
    assert only(
        NODE, "waiting in a callback", "serve(self, request, response):\n        rclpy.spin_until_future_complete("
    )
    assert only(NODE, "call left out", "self.create_service", "pass\n        self.declare_parameter")


def test_callbacks_that_are_no_methods() -> None:
    source = "def tell(message):\n    print(message)\n\n\nnode.create_subscription(String, 'into', tell, 10)\n"
    assert only(source, "exception in a callback", 'tell(message):\n    if hasattr(tell, "called_tell"):')
    assert only(source, "exception in a callback", "tell(message):\n    raise RuntimeError")
    assert only(source, "blocking callback", "time.sleep(3.0)")
    assert only(source, "callback does nothing", "'into', lambda *given: None, 10")


def test_a_parameter_read_once() -> None:
    one = only(NODE, "parameter read once")
    assert (
        'declare_parameter("factor", 0.5)\n        self.read_once_factor = self.get_parameter("factor").value'
        in one.source
    )
    assert "factor = self.read_once_factor" in one.source


def test_goals() -> None:
    assert only(ACTION, "status of a goal", "goal_handle.abort()")
    assert only(ACTION, "status of a goal", "goal_handle.canceled()")
    assert only(ACTION, "call left out", "pass\n        return Move.Result(done=True)")
    assert only(ACTION, "status of a goal", "GoalResponse.REJECT")
    assert only(ACTION, "another value returned", "return Move.Result()")
    once = only(ACTION, "published once")
    assert "if goal_handle.published_1 == 0:\n                goal_handle.publish_feedback(" in once.source
    assert "% 10 == 0" in only(ACTION, "published seldom").source
    assert only(ACTION, "another callback", "execute_callback=self.decide")


def test_answers_are_mixed_up_and_left_out() -> None:
    source = "answers = {\n    'a': ('topic', 'why'),\n    'b': ('action', 'so'),\n}\n"
    assert only(source, "another answer", "'a': ('action', 'why')")
    assert only(source, "another answer", "'b': ('action', 'why')")
    assert only(source, "entry left out", "{\n    'b': ('action', 'so'),\n}")
    assert only(source, "entry left out", "{\n    'a': ('topic', 'why'),\n    }")


def test_branches_left_out() -> None:
    source = "if b:\n    c()\nelse:\n    d()\n    e()\n"
    texts = [one.source for one in made(source) if one.operator == "branch left out"]
    assert texts == ["if b:\n    pass\nelse:\n    d()\n    e()\n", "if b:\n    c()\nelse:\n    pass\n    pass\n"]


@pytest.mark.parametrize("source", [NODE, ACTION])
def test_each_is_python_and_there_once(source: str) -> None:
    found = mutants.of(source)
    meanings = [parsed(one.source) for one in found]
    assert all(meanings)
    assert len(set(meanings)) == len(meanings)
    assert parsed(source) not in meanings
    assert len({(one.key, one.line) for one in found}) == len(found)


def test_what_is_printed_annotated_or_documented_is_left_alone() -> None:
    for one in made(NODE):
        ast.parse(one.source)
        assert "halving_x" not in one.source
        assert '"""A node."""' in one.source
        assert '__name__ == "__main__"' in one.source


def test_keys_stay_when_lines_move_and_other_lines_change() -> None:
    moved = "# a comment\n\n" + NODE.replace("Halves.", "It halves.")
    assert [one.key for one in mutants.of(moved)] == [one.key for one in made(NODE)]
    assert [one.line + 2 for one in made(NODE)] == [one.line for one in mutants.of(moved)]


def test_the_same_mistake_on_lines_of_the_same_text_is_numbered() -> None:
    source = "def a():\n    return b\n\n\ndef c():\n    return b\n"
    keys = [one.key for one in made(source) if one.operator == "return left out"]
    assert keys == ["return left out: return b -> b", "return left out: return b -> b (no. 2)"]


@pytest.mark.parametrize(
    ("seen", "unseen"),
    [
        ("response.success = True", "response.success = False"),
        ("self.count = 0", "response.count = 0"),
        ("a = Range(low=1.0)", "a = Range(low=0.0)"),
        ("a = 'celsius'", "a = 'not a temperature'"),
        ("a = f'{b}: {c}'", "a = f'{b} is too cold for {c}'"),
        ("node.stop()", "node.destroy_node()"),
        ("stop()", "main()"),
        ("rclpy.stop(node)", "rclpy.spin(node)"),
    ],
)
def test_what_nobody_can_see_is_no_mistake(seen: str, unseen: str) -> None:
    """Fields set to their default, words that are free, the end of a program, and main where the class is started."""
    kinds = {"assignment left out", "keyword left out", "another text", "value left out of a text", "call left out"}
    found = [
        [one.operator for one in mutants.of(source, starts_itself=False) if one.operator in kinds]
        for source in (seen, unseen)
    ]
    assert found[0]
    assert found[1] == []


def test_a_program_that_starts_its_node_itself_needs_its_main() -> None:
    assert changed("main()", "call left out") == ["pass"]
    assert changed("rclpy.spin(node)", "call left out") == ["pass"]


def test_letters_of_several_bytes_do_not_shift_a_change() -> None:
    assert changed("a = 'ä°ö' if b < c else d", "edge") == ["a = 'ä°ö' if b <= c else d"]


def test_parentheses_are_added_only_where_they_are_needed() -> None:
    assert "a = (b - c) - d" not in changed("a = b * c - d", "another operator")
    assert changed("a = b ** c", "another operator") == ["a = b * c"]
    assert "a = not (b or c)" in changed("a = not (b and c)", "and for or")
    assert "a = d / (b / c)" in changed("a = d / (b * c)", "another operator")


@pytest.mark.parametrize("name", ["temperature_service", "move_robot", "robot_parameters"])
def test_the_solutions_of_the_course_have_every_kind_of_ros_mistake(name: str) -> None:
    root = environment.checkout()
    assert root is not None
    operators = {one.operator for one in mutants.of((root / "solutions" / name / f"{name}.py").read_text())}
    assert {"endpoint's name", "callback does nothing", "exception in a callback", "call left out"} <= operators


def test_what_is_not_python_is_refused() -> None:
    with pytest.raises(SyntaxError):
        ParsedProgram("def")

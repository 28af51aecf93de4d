"""The mistakes that are made in a solution: each kind on a few lines, each once, under names that stay."""

from __future__ import annotations

import ast
from functools import cache

import pytest

from course_kit.authoring.prove import proving

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

RCLPY, TIME = "__import__('rclpy')", "__import__('time')"
PUBLISH = "self.out.publish(Float64(data=message.data * factor))"


@cache
def made(source: str) -> tuple[proving.Mutant, ...]:
    return tuple(proving.make_mutants(source))


@pytest.mark.parametrize(
    ("source", "operator", "wanted"),
    [
        ("a = (b - c) * d", "another operator", ["(b - c) * d -> (b - c) / d", "b - c -> b + c"]),
        ("a = b + c", "operand forgotten", ["b + c -> b", "b + c -> c"]),
        ("a = -b", "sign or not forgotten", ["-b -> b"]),
        ("a = b and c", "and for or", ["b and c -> b or c"]),
        ("a = b and c", "condition forgotten", ["b -> nothing", "c -> nothing"]),
        ("a = b < c", "edge", ["b < c -> b <= c"]),
        ("a = 0 <= b < c", "condition forgotten", ["0 <= b < c -> 0 <= b", "0 <= b < c -> b < c"]),
        ("a = b == c", "comparison reversed", ["b == c -> b != c"]),
        ("a = -1.5", "another number", ["-1.5 -> -0.5", "-1.5 -> -2.5"]),
        ("a = -1.5", "another sign", ["-1.5 -> 1.5"]),
        ("a = 2.0", "number slightly off", ["2.0 -> 2.002", "2.0 -> 1.998"]),
        ("a = 'b'", "another text", ["'b' -> 'b_x'"]),
        ("a = 'b'", "empty text", ["'b' -> ''"]),
        ("a = True", "true for false", ["True -> False"]),
        ("for a in (b, c):\n    d(a)", "element left out", ["b -> nothing", "c -> nothing"]),
        ("a = b.x", "another field", ["b.x -> b.y", "b.x -> b.z"]),
        ("a = min(b, c)", "another function", ["min -> max"]),
        ("a = b(c, d)", "arguments swapped", ["b(c, d) -> b(d, c)"]),
        ("a = b(c, d=e)", "keyword left out", ["d=e -> nothing"]),
        ("a = b(c, d)", "argument left out", ["d -> nothing"]),
        ("a = b(c)", "function left out", ["b(c) -> c"]),
        ("b.c = d", "assignment left out", ["b.c = d -> pass"]),
        ("if b:\n    c = 1", "condition negated", ["b -> not b"]),
        ("if b:\n    c = 1", "condition never true", ["b -> False"]),
        ("for a in b:\n    c(a)", "loop run once", ["c(a) -> c(a) / break"]),
        ("def a():\n    return b", "return left out", ["return b -> b"]),
        ("def a() -> M.Result:\n    return b", "another value returned", ["b -> None", "b -> M.Result()"]),
        ("a.b()", "call left out", ["a.b() -> pass"]),
        ("n.declare_parameter('a', 3.0)", "parameter's type", ["3.0 -> '3.0'", "3.0 -> 3"]),
        (NODE, "one thread", [f"MultiThreadedExecutor(num_threads=4) -> {RCLPY}.executors.SingleThreadedExecutor()"]),
        (NODE, "one spin", ["executor.spin() -> executor.spin_once()"]),
    ],
)
def test_each_kind_of_mistake(source: str, operator: str, wanted: list[str]) -> None:
    assert [one.change for one in made(source) if one.operator == operator] == wanted


def only(source: str, operator: str, part: str) -> proving.Mutant:
    """The one mutant of an operator whose text has this part."""
    found = [one for one in made(source) if one.operator == operator and part in one.source]
    assert len(found) == 1, [one.key for one in found]
    return found[0]


def test_mistakes_with_endpoints_and_callbacks() -> None:
    assert only(NODE, "endpoint's name", "'outs'")
    assert only(NODE, "endpoint's name", "'~/into'")
    assert "BEST_EFFORT" in only(NODE, "quality of service", f"self.halve, {RCLPY}.qos.QoSProfile(depth=10, rel").change
    assert only(NODE, "quality of service", f"self.serve, qos_profile={RCLPY}.qos.QoSProfile(depth=10, reliability")
    assert only(NODE, "endpoint destroyed", "self.destroy_subscription(self.create_subscription(")
    assert only(NODE, "another type", "create_publisher(__import__('std_msgs.msg'")
    assert only(NODE, "published twice", f"{PUBLISH}\n        {PUBLISH}")
    assert only(NODE, "callback does nothing", "'into', lambda *given: None, 10")
    assert only(NODE, "another callback", "'into', self.serve, 10")
    assert only(NODE, "exception in a callback", 'Publish half."""\n        raise RuntimeError')
    assert only(NODE, "exception in a callback", "hasattr(self, 'called_halve')")
    assert only(NODE, "blocking callback", f'Publish half."""\n        {TIME}.sleep(')
    assert only(NODE, "waiting in a callback", f"response):\n        {RCLPY}.spin_until_future_complete(")
    source = "def tell(message):\n    print(message)\n\n\nnode.create_subscription(String, 'into', tell, 10)\n"
    assert only(source, "exception in a callback", "tell(message):\n    if hasattr(tell, 'called_tell'):")


def test_goals() -> None:
    assert only(ACTION, "status of a goal", "goal_handle.abort()")
    assert only(ACTION, "status of a goal", "goal_handle.canceled()")
    assert only(ACTION, "status of a goal", "GoalResponse.REJECT")
    assert only(ACTION, "another value returned", "return Move.Result()")
    assert only(ACTION, "published once", "if goal_handle.published_1 == 0:\n                goal_handle.publish_feed")
    assert only(ACTION, "published seldom", "% 10 == 0")
    assert only(ACTION, "another callback", "execute_callback=self.decide")


@pytest.mark.parametrize("source", [NODE, ACTION])
def test_each_is_python_and_there_once_and_what_is_printed_or_documented_is_left_alone(source: str) -> None:
    texts = [ast.unparse(ast.parse(one.source)) for one in made(source)]
    assert len({ast.unparse(ast.parse(source)), *texts}) == len(texts) + 1
    assert len({(one.key, one.line) for one in made(source)}) == len(texts)
    for text in texts if source == NODE else ():
        assert "halving_x" not in text
        assert '"""A node."""' in text
        assert "__name__ == '__main__'" in text


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
        [one.operator for one in proving.make_mutants(source, starts_itself=False) if one.operator in kinds]
        for source in (seen, unseen)
    ]
    assert found[0]
    assert found[1] == []

"""What a learner reads after the usual mistakes, in a real kernel."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit.lab.notebook.cells import LINES
from tests.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from tests.lab.kernel import Kernel

IMPORTS = """
import asyncio
import rclpy
from course_kit import interfaces, lab
from example_interfaces.action import Fibonacci
from geometry_msgs.msg import Point, PoseStamped
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionServer
from rclpy.node import Node
from std_srvs.srv import SetBool
"""


def node(init: str, *methods: str) -> str:
    """A cell with a node: the body of its `__init__`, its methods, and its start. The imports take the first lines."""
    lines = ["class Learner(Node):", "    def __init__(self):", '        super().__init__("learner")']
    lines += [f"        {line}" for line in init.splitlines()]
    lines += [f"    {line}" for method in methods for line in method.splitlines()]
    return "\n".join([*lines, "lab.start(Learner)"])


ANSWER = "def answer(self, request, response):\n    return response"


@pytest.fixture(autouse=True)
def _imported(kernel: Kernel) -> None:
    assert kernel.run(IMPORTS).ok


@pytest.mark.parametrize(
    ("cell", "sentence"),
    [
        ("lab.call('/ask', SetBool, data=True).success", "Nothing was sent: write `await lab.call(...)`."),
        ("lab.send_goal('/f', Fibonacci, order=3).result()", "Nothing was sent: write `await lab.send_goal(...)`."),
        ("lab.get_parameters('/learner')['speed']", "Nothing was sent: write `await lab.get_parameters(...)`."),
        ("for one in lab.next_messages('/chatter', Point): pass", "write `await lab.next_messages(...)`."),
        ("async for one in lab.send_goal('/f', Fibonacci): pass", "write `await lab.send_goal(...)`."),
    ],
)
def test_a_forgotten_await_is_named_where_the_answer_is_used(kernel: Kernel, cell: str, sentence: str) -> None:
    shown = kernel.run(cell)
    assert shown.error.startswith("NotAwaitedError: ")
    assert shown.error.endswith(sentence)


def test_a_forgotten_await_is_named_where_nothing_uses_the_answer(kernel: Kernel) -> None:
    sentence = "Nothing was sent: write `await lab.call(...)`."
    assert kernel.run("lab.call('/ask', SetBool, data=True)").result["text/plain"] == sentence
    assert kernel.run("answer = lab.call('/ask', SetBool, data=True)").stderr == f"{sentence}\n"
    assert kernel.run("lab.call('/ask', SetBool, data=True)\nprint('next')").stderr == f"{sentence}\n"
    assert kernel.run("1").stderr == ""


def test_what_is_awaited_later_is_no_mistake(kernel: Kernel) -> None:
    kernel.run(node("self.create_service(SetBool, 'ask', self.answer)", ANSWER))
    call = "lab.call('/ask', SetBool, data=True)"
    for cell in (
        f"print(len(await asyncio.gather({call}, {call})))",
        f"task = asyncio.create_task({call})",
        f"print((await asyncio.wait_for({call}, 5)).success)",
        "print((await task).success)",
    ):
        shown = kernel.run(cell)
        assert (shown.ok, shown.stderr) == (True, ""), shown


def test_an_await_forgotten_on_a_goal_is_named(kernel: Kernel) -> None:
    execute = "def execute(self, goal_handle):\n    goal_handle.succeed()\n    return Fibonacci.Result()"
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", execute))
    kernel.run("goal = await lab.send_goal('/f', Fibonacci, order=3)")
    assert "write `await goal.result(...)`" in kernel.run("goal.result().sequence").error
    assert "write `await goal.cancel(...)`" in kernel.run("agreed = goal.cancel()").stderr


@pytest.mark.parametrize(
    ("init", "method", "function"),
    [
        ("self.create_timer(0.1, self.tick())", "def tick(self):\n    pass", "create_timer()"),
        ("self.create_service(SetBool, 'ask', self.tick())", "def tick(self):\n    pass", "create_service()"),
        ("self.create_subscription(Point, 'p', self.tick(), 10)", "def tick(self):\n    pass", "create_subscription()"),
        ("ActionServer(self, Fibonacci, 'f', self.tick())", "def tick(self):\n    pass", "ActionServer()"),
    ],
)
def test_a_callback_that_was_called_is_named_with_its_line(
    kernel: Kernel, init: str, method: str, function: str
) -> None:
    shown = kernel.run(node(init, method))
    assert shown.error.startswith(f"CallbackError: {function} was given None where it takes a function")
    assert f"line 4: {init}" in shown.error
    assert shown.error.endswith("write self.tick, not self.tick().")
    assert kernel.run("lab.nodes()").result["text/plain"] == "No node is running in the lab."


def test_a_method_without_self_is_named(kernel: Kernel) -> None:
    kernel.run(
        node("self.create_service(SetBool, 'ask', self.answer)", "def answer(request, response):\n    return response")
    )
    shown = kernel.run("await lab.call('/ask', SetBool)")
    assert "line 5: def answer(request, response):" in shown.stderr
    assert "answer() has no self. Write: def answer(self, request, response):" in shown.stderr
    assert "__init__() has no self. Write: def __init__(self):" in kernel.run(node("").replace("(self)", "()")).error
    forgotten = kernel.run(node("create_service(SetBool, 'ask', self.answer)", ANSWER))
    assert "create_service belongs to the node. Write: self.create_service(...)" in forgotten.error
    assert "belongs" not in kernel.run(node("create_servant()")).stderr


def test_a_callback_with_too_few_parameters_is_given_the_right_ones(kernel: Kernel) -> None:
    kernel.run(node("self.create_service(SetBool, 'ask', self.answer)", "def answer(self, request):\n    return 1"))
    shown = kernel.run("await lab.call('/ask', SetBool)")
    assert "rclpy calls it with request and response. Write: def answer(self, request, response):" in shown.stderr
    execute = "def execute(self):\n    return Fibonacci.Result()"
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", execute))
    shown = kernel.run("await (await lab.send_goal('/f', Fibonacci, order=3)).result()")
    assert "rclpy calls it with goal_handle. Write: def execute(self, goal_handle):" in shown.stderr
    result = "def execute(self, goal_handle):\n    goal_handle.succeed(Fibonacci.Result())"  # as from Lyrical on
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", result))
    shown = kernel.run("await (await lab.send_goal('/f', Fibonacci, order=3)).result()")
    assert "succeed() takes 1 positional argument" in shown.stderr
    assert "Write: def" not in shown.stderr


@pytest.mark.parametrize(
    ("ending", "what"),
    [
        ("", "returned nothing."),
        ("return Fibonacci.Result", "returned the class Fibonacci_Result, without parentheses."),
        ("return [1, 2]", "returned list, which is not a result of example_interfaces/action/Fibonacci."),
    ],
)
def test_an_execute_without_a_result_is_told_at_once(kernel: Kernel, ending: str, what: str) -> None:
    execute = f"def execute(self, goal_handle):\n    goal_handle.succeed()\n    {ending}"
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", execute))
    shown = kernel.run(
        "goal = await lab.send_goal('/f', Fibonacci, order=3)\nprint(await goal.result(timeout=600), goal.status)"
    )
    assert shown.ok, shown.error
    assert shown.stdout == "example_interfaces.action.Fibonacci_Result(sequence=[]) SUCCEEDED\n"
    assert f"learner: execute {what} End it with `return Fibonacci.Result(...)`." in shown.stderr
    assert "line 5: def execute(self, goal_handle):" in shown.stderr
    assert "In a separate program it would wait for ever." in shown.stderr


def test_feedback_without_parentheses_is_named(kernel: Kernel) -> None:
    execute = (
        "def execute(self, goal_handle):\n    feedback = Fibonacci.Feedback\n    {}\n"
        "    goal_handle.publish_feedback(feedback)\n    goal_handle.succeed()\n    return Fibonacci.Result()"
    )
    wait = "await (await lab.send_goal('/f', Fibonacci, order=3)).result()"
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", execute.format("pass")))
    assert "a message of this action's Feedback, made with parentheses: Feedback()." in kernel.run(wait).stderr
    setting = execute.format("feedback.sequence = [0]")
    kernel.run(node("self.server = ActionServer(self, Fibonacci, 'f', self.execute)", setting))
    said = kernel.run(wait).stderr
    assert "Fibonacci.Feedback is the type, not a message: make one with Fibonacci.Feedback()" in said
    # And the type is as it was: the field is not lost to everybody.
    assert kernel.run("print(list(Fibonacci.Feedback(sequence=[1]).sequence))").stdout == "[1]\n"


def test_a_misspelt_parameter_is_told_which_there_are(kernel: Kernel) -> None:
    said = "The node has declared max_velocity. Did you mean max_velocity?"
    declared = "self.declare_parameter('max_velocity', 1.0)\n"
    assert said in kernel.run(node(f"{declared}self.get_parameter('max_velocty')")).error
    wrong = "def answer(self, request, response):\n    self.get_parameter('max_velocty')"
    kernel.run(node(f"{declared}self.create_service(SetBool, 'ask', self.answer)", wrong))
    assert said in kernel.run("await lab.call('/ask', SetBool)").stderr


def test_input_in_a_callback_is_refused_whether_a_cell_runs_or_not(kernel: Kernel, tmp_path: Path) -> None:
    tick = (
        "def answer(self, request, response):\n    response.message = input('what? ')\n    return response\n"
        "def tick(self):\n    input('what? ')"
    )
    kernel.run(
        node("self.create_service(SetBool, 'ask', self.answer)\nself.timer = self.create_timer(3600, self.tick)", tick)
    )
    shown = kernel.run("await lab.call('/ask', SetBool)")
    assert "answer was stopped: input() in a callback would stop every node until somebody types." in shown.stderr
    assert "line 7: response.message = input('what? ')" in shown.stderr
    told = tmp_path / "told"
    kernel.run(  # the kernel puts Python's own `input` back when a cell has ended
        "import builtins, json, threading\n"
        "def ask():\n    ended.wait()\n    lab.current().engine.executor.create_task(look)\n"
        "def look():\n    try:\n        input()\n    except BaseException as error:\n"
        f"        open({str(told)!r}, 'w').write(json.dumps(type(error).__name__))\n"
        "ended = threading.Event()\nthreading.Thread(target=ask, daemon=True).start()\n"
        "asyncio.get_running_loop().call_later(0.2, ended.set)"
    )
    wait_until(lambda: told.is_file() and told.read_text(), "the callback that asks")
    assert json.loads(told.read_text()) == "InputError"


def test_stop_is_one_line(kernel: Kernel) -> None:
    kernel.run("import time")
    never = "async def answer(self, request, response):\n    await rclpy.task.Future()"
    for waiting in ("await asyncio.sleep(600)", "time.sleep(600)", "lab.call_blocking('/never', SetBool)"):
        kernel.run(node("self.create_service(SetBool, 'never', self.answer)", never))
        message = kernel.send(f"'first'\n(print('go', flush=True), {waiting})")
        kernel.finish(message, until="go")
        kernel.manager.interrupt_kernel()
        error = kernel.finish(message).error
        assert re.fullmatch(r"Interrupted in In\[\d+\], line 2; your nodes go on\.", error)
        assert "learner (Learner)" in kernel.run("lab.nodes()").result["text/plain"]
    kernel.run("lab.stop()")


INTERRUPT_BEFORE_SECOND = """
shell, run = get_ipython(), get_ipython().run_code
async def interrupted(code, *place, **more):
    if "second" in code.co_names:
        del shell.run_code
        raise KeyboardInterrupt
    return await run(code, *place, **more)
shell.run_code = interrupted
"""


def test_stop_between_two_statements_is_one_line(kernel: Kernel) -> None:
    kernel.run(node("pass"))
    kernel.run(f"exec(compile({INTERRUPT_BEFORE_SECOND!r}, 'not a cell', 'exec'))")
    error = kernel.run("first = 1\nsecond = 2").error
    assert re.fullmatch(r"Interrupted in In\[\d+\]; your nodes go on\.", error)
    assert kernel.run("first").result["text/plain"] == "1"
    assert "NameError" in kernel.run("second").error
    kernel.run("lab.stop()")


def test_a_node_that_nobody_runs_says_so(kernel: Kernel) -> None:
    said = kernel.run(node("").replace("lab.start(Learner)", "Learner()")).result["text/plain"]
    assert said.endswith("Nobody runs this node. lab.start(Learner) makes one and runs it.")
    assert kernel.run(node("")).result["text/plain"] == "learner (Learner)"


def test_spinning_a_class_is_named(kernel: Kernel) -> None:
    kernel.run(node("pass").rpartition("\n")[0])
    assert kernel.run("rclpy.spin(Learner)").error == (
        "LabError: rclpy.spin() takes a node, not a class. In a notebook: lab.start(Learner)."
    )


@pytest.mark.parametrize(
    "flood",
    [
        "for number in range(100_000): print('line', number)",
        "from sys import stderr\nfor number in range(100_000): print('line', number, file=stderr)",
        node("self.create_timer(0.001, self.tick)", "def tick(self):\n    for _ in range(500): print('line', 99_999)")
        + "\nawait asyncio.sleep(1)\nlab.stop()",
    ],
)
def test_a_flood_is_cut_off_with_a_word(kernel: Kernel, flood: str) -> None:
    shown = kernel.run(flood)
    printed = shown.stdout + shown.stderr
    assert len(printed.splitlines()) == LINES + 1
    assert f"... This cell has printed {LINES:,} lines: the rest is left out.\n" in printed
    assert kernel.run("print('fine')").stdout == "fine\n"


def test_tab_after_lab_offers_its_verbs_and_no_module(kernel: Kernel) -> None:
    matches = kernel.complete("lab.")
    assert {"call", "start", "stop", "send_goal", "set_parameters", "diagram", "nodes"} <= matches
    assert not matches & {"api", "calls", "annotations", "singleton", "runtime", "goal_verbs", "recording"}


RANGE = "ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=0, to_value=1.0)])"


@pytest.mark.parametrize(
    ("cell", "line", "said"),
    [
        (node(f'self.declare_parameter("speed", 1.0, {RANGE})'), 4, "takes a float: write 0.0; it was given 0, an int"),
        (
            node("self.add_on_set_parameters_callback(lambda _: None)\nself.declare_parameter('speed', 1.0)"),
            5,
            "with `return SetParametersResult(successful=True)`",
        ),
        (node("").replace('"learner"', '"my node"'), 3, "must not contain characters other than alphanumerics"),
        ("point = Point()\npoint.x = 1", 2, "takes a float: write 1.0; it was given 1, an int"),
        ("THING = Thing()\nTHING.total = 'x'", 2, "has the type int64 and takes a whole number in its range"),
        ("ParameterDescriptor(floating_point_range=FloatingPointRange())", 1, "given rcl_interfaces.msg.Fl"),
        ("Point(1.0, 2.0)", 1, "A message takes its values by name: Point(x=..., y=..., z=...)."),
        ("SetBool.Request(True)", 1, "A message takes its values by name: SetBool.Request(data=...)."),
        ("Node('p').create_publisher(Point, 'p', 1).publish(1.0)", 1, "Make a message of it: Point(...)."),
        ("Node('p').create_publisher('p', Point, 1)", 1, "TypeError: The type comes first, then the name"),
        ("Node('p').create_service('s', SetBool, print)", 1, "AttributeError: The type comes first, then the name"),
        ("Node('p').create_subscription(Point, 'p', print)", 1, "Write 10."),
        ("import rospy", 1, "ROS 2 has rclpy"),
        ("lab.start(Qwxyz)", 1, "No cell that has run defines it."),
        ("del Node\nclass Learner(Node): pass", 2, "Write `from rclpy.node import Node`."),
    ],
)
def test_what_ros_refuses_is_a_sentence_with_the_learners_line(kernel: Kernel, cell: str, line: int, said: str) -> None:
    kernel.run("interfaces.define('of_mistakes/msg/Thing', 'int64 total')\nfrom of_mistakes.msg import Thing")
    shown = kernel.run(cell)
    assert said in shown.error
    assert f", line {line}: " in shown.error
    assert len(shown.error.splitlines()) <= 5


def test_a_name_of_a_cell_that_has_not_run_is_said_to_be_there(kernel: Kernel, tmp_path: Path) -> None:
    elsewhere = "def run():\n    Zvbnq = 1", "%%ros_script other\nKjhgf = 1"
    imports = "from rclpy.node import Node", "from std_msgs.msg import Byte, Char"
    sources = *imports, "class Forgotten: pass", "Qwxyz = Qwxyz", *elsewhere
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "mine.ipynb")
    assert kernel.run(f"import os; os.environ['JPY_SESSION_NAME'] = {str(tmp_path / 'mine.ipynb')!r}").ok
    assert "A cell of this notebook defines it. Run that cell first" in kernel.run("Forgotten()").error
    serving = node("self.create_service(SetBool, 'ask', self.ask)", "def ask(self, asked, response):\n    Forgotten()")
    assert "A cell of this notebook defines it." in kernel.run(f"{serving}\nawait lab.call('/ask', SetBool)").stderr
    assert "Write `from std_msgs.msg import Char`, or run the cell that has it." in kernel.run("Char()").error
    for name in ("Qwxyz = Qwxyz", "Zvbnq", "Kjhgf"):
        assert "No cell that has run defines it." in kernel.run(name).error
    assert "A cell of this notebook" not in kernel.run("raise NameError('mine')").error
    said = kernel.run("del Node\nclass Learner(Node): pass").error
    assert "Write `from rclpy.node import Node`, or run the cell that has it." in said
    assert kernel.run("del os.environ['JPY_SESSION_NAME']\nfrom rclpy.node import Node").ok


def test_who_publishes_nothing_because_its_callback_raises_is_said(kernel: Kernel) -> None:
    init = "self.out = self.create_publisher(Point, 'silent', 10)\nself.create_timer(0.05, self.tick)"
    raising = node(init, "def tick(self):\n    Point(x=1)")
    shown = kernel.run(f"{raising}\nawait lab.next_messages('/silent', Point, timeout=1.0)")
    assert "learner publishes it, but its tick raised AssertionError: The 'x' field must be of type" in shown.error
    assert "takes a float: write 1.0; it was given 1, an int." in shown.stderr

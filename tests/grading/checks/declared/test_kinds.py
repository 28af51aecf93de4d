"""Each kind of declared check: the solution passes, and wrong programs are told what is wrong with them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

import pytest

from course_kit import grading
from course_kit.grading.checks.declared.kinds import KINDS
from tests.grading.checks.declared import kind_checks as checks
from tests.grading.checks.declared.conftest import HINTS, grading_side_by_side, written

if TYPE_CHECKING:
    from collections.abc import Iterator
    from concurrent.futures import Future
    from pathlib import Path
    from typing import TypeAlias

    from course_kit.grading.report import Report

    GradedTests: TypeAlias = dict[str, Future[Report]]

Change = tuple[str, str]


class Wrong(NamedTuple):
    """A mistake in the solution, and what is said about it."""

    check: str
    changes: tuple[Change, ...]
    diagnosis: str | None
    said: str


CASES: dict[str, Wrong] = {
    # offered
    "no service": Wrong(
        checks.OFFERED,
        (("self.create_service(AddTwoInts", "(lambda *_: 0)(AddTwoInts"),),
        "name.service",
        "No service is called /add. The closest is /convert",
    ),
    "service of another name": Wrong(checks.OFFERED, (('"add"', '"adds"'),), "name.service", "The closest is /adds"),
    "service of another type": Wrong(
        checks.OFFERED,
        (('create_service(AddTwoInts, "add", self.add)', 'create_service(ConvertTemperature, "add", self.convert)'),),
        "type.interface",
        "has type course_interfaces/srv/ConvertTemperature, expected example_interfaces/srv/AddTwoInts",
    ),
    "action of another name": Wrong(checks.OFFERED, (('"fib"', '"fibo"'),), "name.action", "The closest is /fibo"),
    "topic of another name": Wrong(
        checks.OFFERED, (('"cmd_out"', '"cmd_vel"'),), "topic.silent", "No node publishes /cmd_out"
    ),
    "topic of another type": Wrong(
        checks.OFFERED,
        (
            ('create_publisher(Float64, "beat"', 'create_publisher(Twist, "beat"'),
            ('Float64(data=self.get_parameter("limit").value)', "Twist()"),
        ),
        "type.interface",
        "with type geometry_msgs/msg/Twist, expected std_msgs/msg/Float64",
    ),
    "best effort": Wrong(
        checks.OFFERED,
        (
            ('"cmd_out", 10)', '"cmd_out", qos_profile_sensor_data)'),
            ("import rclpy\n", "import rclpy\nfrom rclpy.qos import qos_profile_sensor_data\n"),
        ),
        "topic.qos",
        "they do not connect",
    ),
    "topics alone, none there": Wrong(
        checks.TOPICS_OFFERED,
        (('self.pub = self.create_publisher(Twist, "cmd_out", 10)', "self.pub = None"),),
        "topic.silent",
        "No node publishes /cmd_out",
    ),
    "program ends": Wrong(
        checks.OFFERED, (("import time\n", "import time\nraise SystemExit(3)\n"),), "start.exit", "ended"
    ),
    "program crashes": Wrong(
        checks.TOPICS_OFFERED, (("import time\n", "import time\n1 / 0\n"),), "start.crash", "ZeroDivisionError"
    ),
    # node_name
    "node of another name": Wrong(
        checks.NODE_NAME, (('__init__("all_kinds")', '__init__("all_kind")'),), "name.node", "The closest is /all_kind"
    ),
    "node in a namespace": Wrong(
        checks.NODE_NAME,
        (('__init__("all_kinds")', '__init__("all_kinds", namespace="robot")'),),
        "name.node",
        "The closest is /robot/all_kinds",
    ),
    # answers
    "wrong formula": Wrong(checks.CONVERTS, (("+ 32 if", "+ 30 if"),), "math.formula", "value has to be"),
    "lost digits": Wrong(
        checks.CONVERTS,
        (("q.value * 9 / 5 + 32 if", "float(round(q.value * 9 / 5 + 32)) if"),),
        "math.integer_division",
        "digits were lost",
    ),
    "last digits": Wrong(
        checks.CONVERTS + "tolerance = 1e-12\n",
        (("q.value * 9 / 5 + 32 if", "(q.value * 9 / 5 + 32) * 1.00000001 if"),),
        "math.integer_division",
        "digits were lost",
    ),
    "wrong sign": Wrong(
        checks.ADDS, (("r.sum = q.a + q.b", "r.sum = -q.a - q.b"),), "math.formula", "right size and the wrong sign"
    ),
    "nothing filled in": Wrong(checks.ADDS, (("r.sum = q.a + q.b", "pass"),), None, "filled in nothing"),
    "answers one late": Wrong(
        checks.ADDS,
        (("r.sum = q.a + q.b", "r.sum, self.last = getattr(self, 'last', 0), q.a + q.b"),),
        None,
        "one too late",
    ),
    "no return": Wrong(
        checks.ADDS,
        (("r.sum = q.a + q.b\n        return r", "r.sum = q.a + q.b"),),
        "service.no_return",
        "returned None",
    ),
    "raises": Wrong(checks.ADDS, (("r.sum = q.a + q.b", "r.sum = q.a + q.c"),), "service.exception", "AttributeError"),
    "float into an int": Wrong(
        checks.ADDS, (("r.sum = q.a + q.b", "r.sum = float(q.a + q.b)"),), "field.type", "The field 'sum' must be a int"
    ),
    "refuses what is valid": Wrong(
        checks.CONVERTS,
        (("r.success = True", "r.success = q.value > 0.0"),),
        "validation.overzealous",
        "refused a valid request",
    ),
    "blocks": Wrong(
        checks.WITHIN,
        (("r.sum = q.a + q.b", "time.sleep(0.9); r.sum = q.a + q.b"),),
        "service.blocks",
        "every other client has to wait",
    ),
    "too soon": Wrong(
        checks.WITHIN.replace("within_s = 0.4", "not_before_s = 0.4"),
        (),
        None,
        "the work that takes so long was not done",
    ),
    "goal ends too soon": Wrong(
        checks.TAKES_ITS_TIME.replace("0.05", "9.0"), (), None, "the work that takes so long was not done"
    ),
    "hangs": Wrong(
        checks.ADDS, (("r.sum = q.a + q.b", "time.sleep(99)"),), "service.blocks", "Your callback is blocked in line"
    ),
    "deadlock": Wrong(
        checks.ADDS,
        (("r.sum = q.a + q.b", "rclpy.spin_until_future_complete(self, rclpy.task.Future())"),),
        "service.deadlock",
        "",
    ),
    "mixes up calls": Wrong(
        checks.TOGETHER,
        (
            ("r.sum = q.a + q.b", "self.kept = q; time.sleep(0.02); r.sum = self.kept.a + self.kept.b"),
            ('"add", self.add)', '"add", self.add, callback_group=ReentrantCallbackGroup())'),
        ),
        None,
        "another client's request",
    ),
    "slow together": Wrong(
        checks.TOGETHER,
        (("r.sum = q.a + q.b", "time.sleep(0.3); r.sum = q.a + q.b"),),
        "service.blocks",
        "requests were answered in",
    ),
    # refuses
    "accepts everything": Wrong(
        checks.REFUSES,
        (('if q.from_unit not in ("celsius", "fahrenheit") or', "if False and"),),
        "validation.missing",
        "accepted a request that it has to refuse",
    ),
    "accepts what has a name": Wrong(
        checks.REFUSES + "what = \"'the unit ' + request.from_unit\"\n",
        (('if q.from_unit not in ("celsius", "fahrenheit") or', "if False and"),),
        "validation.missing",
        "Your service accepted the unit ",
    ),
    "gives no reason": Wrong(
        checks.REFUSES,
        (('r.message = "unknown unit"', 'r.message = " "'),),
        "validation.no_reason",
        "its message is empty",
    ),
    "dies of it": Wrong(
        checks.REFUSES, (('r.message = "unknown unit"', 'raise ValueError("unit")'),), "service.exception", "ValueError"
    ),
    "refuses everything after it": Wrong(
        checks.CONVERTS_AND_REFUSES,
        (
            ('r.message = "unknown unit"', 'self.offended = True; r.message = "unknown unit"'),
            ("r.success = True", 'r.success = not hasattr(self, "offended")'),
        ),
        "validation.overzealous",
        "refused a valid request",
    ),
    # topic_answers
    "does not limit": Wrong(
        checks.LIMITS, (("m.linear.x = max(-v, min(v, m.linear.x))", "pass"),), "math.formula", "linear.x has to be"
    ),
    "limits one side": Wrong(
        checks.LIMITS, (("max(-v, min(v, m.linear.x))", "min(v, m.linear.x)"),), "math.formula", "linear.x has to be"
    ),
    "spoils another field": Wrong(
        checks.LIMITS, (("self.pub.publish(m)", "m.angular.z = 0.0; self.pub.publish(m)"),), "math.formula", "angular.z"
    ),
    "publishes nothing": Wrong(
        checks.LIMITS, (("self.pub.publish(m)", "pass"),), "topic.silent", "published none on /cmd_out"
    ),
    "publishes the message before": Wrong(
        checks.LIMITS,
        (("self.pub.publish(m)", "self.pub.publish(getattr(self, 'last', m)); self.last = m"),),
        None,
        "one too late",
    ),
    "publishes twice": Wrong(
        checks.EXACTLY_ONE,
        (("self.pub.publish(m)", "self.pub.publish(m); self.pub.publish(m)"),),
        None,
        "Publish once for each message",
    ),
    "publishes once more, later": Wrong(
        checks.EXACTLY_ONE,
        (
            ("self.pub.publish(m)", "self.pub.publish(m); self.m = m"),
            ("self.beat.publish(", "hasattr(self, 'm') and self.pub.publish(self.m); self.beat.publish("),
        ),
        None,
        "Publish once for each message",
    ),
    "raises in a subscription": Wrong(
        checks.LIMITS, (("self.pub.publish(m)", "self.pub.publish(m.linear)"),), None, "TypeError"
    ),
    # parameter_declared
    "not declared": Wrong(
        checks.DECLARED,
        (('"limit", 1.0', '"limits", 1.0'), ('get_parameter("limit")', 'get_parameter("limits")')),
        "parameter.undeclared",
        "has not declared limit",
    ),
    "declared as an integer": Wrong(
        checks.DECLARED,
        (('"limit", 1.0', '"limit", 1'), ('data=self.get_parameter("limit").value', "data=1.0")),
        "parameter.type",
        "limit is integer, expected double. A double needs a decimal point.",
    ),
    "one of several not declared": Wrong(
        checks.ALL_DECLARED,
        (('"limit", 1.0', '"limits", 1.0'), ('get_parameter("limit")', 'get_parameter("limits")')),
        "parameter.undeclared",
        "Your node has not declared limit.",
    ),
    "one of several of another default": Wrong(
        checks.DEFAULTS, (('"limit", 1.0', '"limit", 1.5'),), "parameter.default", "your node has limit=1.5."
    ),
    "another default": Wrong(
        checks.DECLARED, (('"limit", 1.0', '"limit", 1.5'),), "parameter.default", "your node has limit=1.5"
    ),
    # parameter_acts
    "read once": Wrong(
        checks.ACTS,
        (
            (
                'v = self.get_parameter("limit").value',
                'self.v = v = getattr(self, "v", 0.0) or self.get_parameter("limit").value',
            ),
        ),
        "parameter.read_once",
        "the same as before",
    ),
    "acts wrongly": Wrong(
        checks.ACTS,
        (('v = self.get_parameter("limit").value', 'v = self.get_parameter("limit").value * 1.01'),),
        "math.formula",
        "linear.x has to be",
    ),
    "refuses a valid value": Wrong(checks.ACTS, (("<= 5.0:", "<= 1.0:"),), "validation.overzealous", "which is valid"),
    "callback returns nothing": Wrong(
        checks.ACTS,
        (("return SetParametersResult(successful=True)", "return self.count_parameters_of_this_node"),),
        "parameter.bad_callback",
        "",
    ),
    "read once, heard": Wrong(
        checks.ACTS_ALONE,
        (
            (
                'self.beat.publish(Float64(data=self.get_parameter("limit").value))',
                "self.beat.publish(Float64(data=1.0))",
            ),
        ),
        "parameter.read_once",
        "the same as before",
    ),
    "silent": Wrong(
        checks.ACTS_ALONE, (("self.beat.publish(", "(lambda _: 0)("),), "topic.silent", "Nothing is published on /beat"
    ),
    "start value ignored": Wrong(
        checks.ACTS_AT_START,
        (('self.declare_parameter("limit", 1.0)', 'self.declare_parameter("limit", 1.0, ignore_override=True)'),),
        "parameter.override_ignored",
        "its parameters have others",
    ),
    "start value has no effect": Wrong(
        checks.ACTS_AT_START,
        (('v = self.get_parameter("limit").value', "v = 1.0"),),
        "parameter.override_ignored",
        "acts on another",
    ),
    # parameter_refuses
    "accepts a bad value": Wrong(
        checks.PARAMETER_REFUSES, (("<= 5.0:", "<= 50.0:"),), "validation.missing", "accepted limit="
    ),
    "refuses without a reason": Wrong(
        checks.PARAMETER_REFUSES,
        (('reason="limit must be in 0.0 < limit <= 5.0"', 'reason=""'),),
        "validation.no_reason",
        "It is empty",
    ),
    "reason without the range": Wrong(
        checks.PARAMETER_REFUSES,
        (("limit must be in 0.0 < limit <= 5.0", "limit is bad"),),
        "validation.no_reason",
        "It does not name 5.0",
    ),
    "any type": Wrong(
        checks.PARAMETER_REFUSES,
        (
            (
                'self.declare_parameter("limit", 1.0)',
                'self.declare_parameter("limit", 1.0, ParameterDescriptor(dynamic_typing=True))',
            ),
            ("not 0.0 < p.value", "isinstance(p.value, float) and not 0.0 < p.value"),
            ("import SetParametersResult", "import ParameterDescriptor, SetParametersResult"),
            # Else the timer ends the program, which may be seen before the answer is.
            ('data=self.get_parameter("limit").value', "data=1.0"),
        ),
        "parameter.type",
        "accepted limit='fast'",
    ),
    "undeclared is welcome": Wrong(
        checks.PARAMETER_REFUSES,
        (('__init__("all_kinds")', '__init__("all_kinds", allow_undeclared_parameters=True)'),),
        "parameter.undeclared",
        "accepted unknown=3",
    ),
    "keeps half of it": Wrong(
        checks.NOT_ATOMIC,
        (
            (
                "for p in ps:\n",
                "for p in ps:\n            self.ready and p.name == 'name' and self._parameters.update(name=p)\n",
            ),
            (
                'self.declare_parameter("name", "rover")',
                'self.ready = False; self.declare_parameter("name", "rover"); self.ready = True',
            ),
        ),
        "parameter.not_atomic",
        "changed although",
    ),
    # goal_succeeds
    "rejects all": Wrong(
        checks.SUCCEEDS,
        (("if self.busy or", "if True or"),),
        "action.rejects_all",
        "Each of 2 valid goals was rejected",
    ),
    "rejects one": Wrong(
        checks.SUCCEEDS,
        (("if self.busy or", "if g.order == 5 or"),),
        "validation.overzealous",
        "which your server accepted",
    ),
    "no succeed()": Wrong(
        checks.SUCCEEDS, (("h.succeed()", "pass"),), "action.no_terminal", "without saying how the goal ended"
    ),
    "abort()": Wrong(checks.SUCCEEDS, (("h.succeed()", "h.abort()"),), "action.wrong_terminal", "ABORTED"),
    "no result": Wrong(
        checks.SUCCEEDS,
        (("h.succeed()\n            return Fibonacci.Result(sequence=f.sequence)", "h.succeed()\n            return"),),
        "action.no_result",
        "returned None",
    ),
    "empty result": Wrong(
        checks.SUCCEEDS,
        (
            (
                "h.succeed()\n            return Fibonacci.Result(sequence=f.sequence)",
                "h.succeed()\n            return Fibonacci.Result()",
            ),
        ),
        None,
        "filled in nothing",
    ),
    "another result": Wrong(
        checks.SUCCEEDS,
        (
            (
                "h.succeed()\n            return Fibonacci.Result(sequence=f.sequence)",
                "h.succeed()\n            return Fibonacci.Result(sequence=f.sequence[1:])",
            ),
        ),
        None,
        "sequence has to be",
    ),
    "never ends": Wrong(checks.SUCCEEDS, (("h.succeed()", "time.sleep(99)"),), "limit.time", "still running"),
    # goal_feedback
    "no feedback": Wrong(
        checks.FEEDBACK, (("h.publish_feedback(f)", "pass"),), "action.no_feedback", "0 feedback messages"
    ),
    "feedback at the end": Wrong(
        checks.FEEDBACK,
        (("h.publish_feedback(f)", "pass"), ("h.succeed()", "[h.publish_feedback(f) for _ in range(9)]; h.succeed()")),
        "action.late_feedback",
        "one burst",
    ),
    "last feedback not full": Wrong(
        checks.FEEDBACK,
        (("h.publish_feedback(f)", "h.publish_feedback(Fibonacci.Feedback(sequence=f.sequence[:-1]))"),),
        None,
        "The last feedback has to say",
    ),
    "feedback falls": Wrong(
        checks.MONOTONIC, (("float(i)\n", "float(-i)\n"),), "action.feedback_not_monotonic", "position.x falls"
    ),
    "feedback grows": Wrong(
        checks.MONOTONIC,
        (("distance_remaining=float(9 - i)", "distance_remaining=float(i)"),),
        "action.feedback_not_monotonic",
        "distance_remaining grows",
    ),
    "first feedback wrong": Wrong(
        checks.MONOTONIC, (("progress=i / 8", "progress=(i + 1) / 9"),), None, "The first feedback has to say"
    ),
    "feedback contradicts itself": Wrong(
        checks.MONOTONIC,
        (("distance_remaining=float(9 - i)", "distance_remaining=20.0 - i"),),
        None,
        "Each feedback has to follow",
    ),
    # goal_refused
    "accepts anything": Wrong(
        checks.REJECTS, (("or not 0 <= g.order <= 50", ""),), "action.accepts_impossible", "has to reject"
    ),
    "accepts a goal that has a name": Wrong(
        checks.REJECTS + "what = \"'this goal, which is too long'\"\n",
        (("or not 0 <= g.order <= 50", ""),),
        "action.accepts_impossible",
        "Your server accepted this goal, which is too long.",
    ),
    "accepts too large": Wrong(
        checks.REJECTS, (("g.order <= 50", "g.order <= 51"),), "action.accepts_impossible", "has to reject"
    ),
    "two at a time": Wrong(
        checks.SECOND, (("if self.busy or", "if"),), "action.concurrent_goals", "while the first was running"
    ),
    # goal_cancelled
    "cancel refused": Wrong(
        checks.CANCEL,
        (("CancelResponse.ACCEPT", "CancelResponse.REJECT"),),
        "action.cancel_refused",
        "refused to cancel",
    ),
    "cancel ignored": Wrong(
        checks.CANCEL, (("if h.is_cancel_requested:", "if False:"),), "action.cancel_ignored", "went on to its end"
    ),
    "cancel blocked": Wrong(
        checks.CANCEL,
        (
            ("cancel_callback=cancel, callback_group=ReentrantCallbackGroup())", "cancel_callback=cancel)"),
            ("class AllKinds", "def main():\n    rclpy.init()\n    rclpy.spin(AllKinds())\n\n\nclass AllKinds"),
            (
                "        return MoveRobot.Result()\n",
                "        return MoveRobot.Result()\n\n\nif __name__ == '__main__':\n    main()\n",
            ),
        ),
        "action.cancel_blocked",
        "before the goal was over",
    ),
    "aborted instead": Wrong(checks.CANCEL, (("h.canceled()", "h.abort()"),), "action.wrong_terminal", "ABORTED"),
    "no canceled()": Wrong(checks.CANCEL, (("h.canceled()", "pass"),), "action.no_terminal", "ABORTED"),
    "no goal after it": Wrong(
        checks.CANCEL,
        (
            ("h.canceled()", "self.stuck = True; h.canceled()"),
            ("if self.busy or", "if self.busy or hasattr(self, 'stuck') or"),
        ),
        "validation.overzealous",
        "rejected the next one",
    ),
}


RIGHT = [name for name in vars(checks) if name.isupper()]


def ids_of(text: str) -> list[str]:
    return re.findall(r'^id = "(\w+)"', text, re.MULTILINE)


def without_doubles(names: list[str]) -> list[list[str]]:
    """The names in as few lists as can be, in each of which no two of their checks have the same id."""
    found: list[list[str]] = []
    for name in names:
        own = set(ids_of(getattr(checks, name)))
        fitting = (some for some in found if not own & {one for each in some for one in ids_of(getattr(checks, each))})
        next(fitting, found.append([]) or found[-1]).append(name)
    return [some for some in found if some]


@pytest.fixture(scope="module")
def reports(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[GradedTests]:
    """What the tests of this module that are run need, graded side by side; of the solution many checks at once."""
    here = [item for item in request.session.items if item.path == request.path and isinstance(item, pytest.Function)]
    names = [str(item.callspec.params["name"]) for item in here if hasattr(item, "callspec")]
    with grading_side_by_side(tmp_path_factory.mktemp("kinds")) as begin:
        found: GradedTests = {name: begin(CASES[name].check, *CASES[name].changes) for name in names if name in CASES}
        for together in without_doubles([name for name in names if name in RIGHT]):
            report = begin("".join(getattr(checks, name) for name in together))
            found.update(dict.fromkeys(together, report))
        yield found


@pytest.mark.parametrize("name", RIGHT)
def test_the_solution_passes(reports: GradedTests, name: str) -> None:
    report = reports[name].result()
    assert report.status == "graded", report.problem
    own = [found for found in report.checks if found.id in ids_of(getattr(checks, name))]
    assert own
    for found in own:
        assert (found.status, found.message) == ("passed", "")
        assert found.expected
        assert found.got


def test_every_kind_is_tried() -> None:
    tried = "".join(wrong.check for wrong in CASES.values())
    assert [kind for kind in KINDS if f'kind = "{kind}"' not in tried] == []


@pytest.mark.parametrize("name", CASES)
def test_a_wrong_program_is_told_what_is_wrong(reports: GradedTests, name: str) -> None:
    wrong, report = CASES[name], reports[name].result()
    assert report.problem == ""
    found = report.checks[-1]
    assert (found.status, found.known and found.known.code) == ("failed", wrong.diagnosis), (found.told, report.stderr)
    assert wrong.said in found.told
    assert found.expected
    assert found.got


def test_the_time_to_start_that_is_named_is_no_longer_than_the_checks(worker: grading.Worker, tmp_path: Path) -> None:
    quick = checks.OFFERED.replace("[[checks]]", "[[checks]]\ndeadline_s = 1.5", 1)
    path = written(tmp_path, quick, more=f"{HINTS}[limits]\nstart_s = 60.0\n")
    program = tmp_path / "answer.py"
    program.write_text("import time\ntime.sleep(60)\n")
    report = grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent)
    assert "no node appeared on the graph within 1.5 s" in report.checks[0].message

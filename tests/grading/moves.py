"""Programs for exercise 2 that are wrong in one place each, made from a right one."""

from __future__ import annotations

from dataclasses import dataclass

from tests.grading.conftest import ROOT

FOLDER = ROOT / "tests" / "grading" / "correct" / "move_robot"
RIGHT = (FOLDER / "main_guarded.py").read_text()
_IMPORT = "from course_kit.robot import SimulatedRobot\n"
_BEGIN = "        begin = self.robot.position\n"
_END = "        goal_handle.succeed()\n        return self.result(begin)\n"
_CANCEL = "                goal_handle.canceled()\n                return self.result(begin)\n"
_TRAVELLED = "        result.distance_travelled = math.dist(begin, self.robot.position)\n"
_PROGRESS = "feedback.progress = 1.0 - feedback.distance_remaining / way"
_FREE = "        finally:\n            self.busy = False\n"


@dataclass(frozen=True)
class Slip:
    """One mistake: what replaces what, the check it fails, the code it gets and a fact its message names."""

    name: str
    check: str
    code: str | None
    fact: str
    changes: tuple[tuple[str, str], ...]

    def source(self) -> str:
        """The program with the mistake."""
        text = RIGHT
        for old, new in self.changes:
            if old not in text:
                raise ValueError(f"{self.name}: the right program has no {old!r}")
            text = text.replace(old, new)
        return text


def _slip(name: str, check: str, code: str | None, fact: str, *changes: tuple[str, str]) -> Slip:
    return Slip(name, check, code, fact, changes)


SLIPS = (
    _slip(
        "refuses the near half",
        "accepted",
        "validation.overzealous",
        "was accepted",
        ("if self.busy or", "if x < 1.0 or self.busy or"),
    ),
    _slip(
        "goal callback raises",
        "accepted",
        "service.exception",
        "AttributeError",
        ("x, y = goal.target.x, goal.target.y", "x, y = goal.x, goal.y"),
    ),
    _slip(
        "never free again",
        "succeeds",
        None,
        "still believes that an earlier one runs",
        (_FREE, "        finally:\n            pass\n"),
    ),
    _slip(
        "never ends",
        "succeeds",
        "limit.time",
        "self.robot.step_towards(*target)",
        ("> 0.001", "> -1.0"),
        ("if goal_handle.is_cancel_requested", "if False"),
    ),
    _slip(
        "never begins",
        "succeeds",
        None,
        "No callback is at work on it",
        (
            "            cancel_callback=",
            "            handle_accepted_callback=lambda _: None,\n            cancel_callback=",
        ),
    ),
    _slip(
        "aborts",
        "succeeds",
        "action.wrong_terminal",
        "ended the goal as ABORTED",
        (_END, _END.replace("succeed", "abort")),
    ),
    _slip(
        "cancels what nobody cancelled",
        "succeeds",
        "action.wrong_terminal",
        "canceled() in line",
        (_END, _END.replace("succeed", "canceled")),
    ),
    _slip(
        "returns nothing", "succeeds", "action.no_result", "returned None", (_END, "        goal_handle.succeed()\n")
    ),
    _slip(
        "feedback of the wrong type",
        "succeeds",
        None,
        "TypeError",
        ("feedback = MoveRobot.Feedback()", "feedback = MoveRobot.Result()"),
        ("        feedback.position.x, feedback.position.y = self.robot.position\n", ""),
        ("        feedback.distance_remaining = math.dist(self.robot.position, target)\n", ""),
        (f"        {_PROGRESS}\n", ""),
    ),
    _slip(
        "empty result",
        "arrives",
        None,
        "nobody filled in",
        (_END, "        goal_handle.succeed()\n        return MoveRobot.Result()\n"),
    ),
    _slip(
        "adds up all moves",
        "distance",
        None,
        "all moves so far together",
        ("self.busy = False\n        self.server", "self.busy = False\n        self.total = 0.0\n        self.server"),
        (
            _TRAVELLED,
            (
                "        self.total += math.dist(begin, self.robot.position)\n"
                "        result.distance_travelled = self.total\n"
            ),
        ),
    ),
    _slip("no distance", "distance", None, "not filled in", (_TRAVELLED, "        result.message = str(begin)\n")),
    _slip(
        "a new robot for each goal",
        "distance",
        None,
        "the way from (0.00, 0.00)",
        (_BEGIN, f"        self.robot = SimulatedRobot()\n{_BEGIN}"),
    ),
    _slip(
        "counts z",
        "any_z",
        "limit.time",
        "at work, in line",
        (
            "        while math.dist(self.robot.position, target) > 0.001:",
            (
                "        z = goal_handle.request.target.z\n"
                "        while not math.dist((*self.robot.position, 0.0), (*target, z)) <= 0.001:"
            ),
        ),
    ),
    _slip(
        "divides by the way",
        "already_there",
        None,
        "ZeroDivisionError",
        ("        while math.dist(self", "        self.tell(goal_handle, target, way)\n        while math.dist(self"),
    ),
    _slip(
        "thinks before it drives",
        "already_there",
        "limit.time",
        "time.sleep(7.0)",
        (
            "        while math.dist(self",
            "        if way < 0.01:\n            time.sleep(7.0)\n        while math.dist(self",
        ),
        ("import math\n", "import math\nimport time\n"),
    ),
    _slip(
        "no walls",
        "outside",
        "action.accepts_impossible",
        "the arena ends at 0 and at 10 m",
        ("(0.0 <= x <= 10.0 and 0.0 <= y <= 10.0)", "(math.isfinite(x) and math.isfinite(y))"),
    ),
    _slip(
        "progress in percent",
        "progress",
        "action.feedback_not_monotonic",
        "not between 0 and 1",
        (_PROGRESS, "feedback.progress = 100.0 - 100.0 * feedback.distance_remaining / way"),
    ),
    _slip(
        "half of the progress",
        "progress",
        None,
        "progress=0.5",
        (_PROGRESS, "feedback.progress = 0.5 - 0.5 * feedback.distance_remaining / way"),
    ),
    _slip(
        "no position",
        "progress",
        None,
        "Was feedback.position filled in?",
        ("        feedback.position.x, feedback.position.y = self.robot.position\n", ""),
    ),
    _slip(
        "lets the second wait",
        "second_goal",
        None,
        "accepted a second goal while the first was running",
        ("if self.busy or not", "if not"),
        ("self.busy = False\n        self.server", "self.lock = threading.Lock()\n        self.server"),
        (
            "        try:\n            return self.drive(goal_handle)\n" + _FREE,
            "        with self.lock:\n            return self.drive(goal_handle)\n",
        ),
        ("        self.busy = True\n", ""),
        ("import math\n", "import math\nimport threading\n"),
    ),
    _slip(
        "cancelled without an end",
        "cancel",
        "action.no_terminal",
        "had not said how the goal ended",
        (_CANCEL, "                return self.result(begin)\n"),
    ),
    _slip(
        "cancelled as a success",
        "cancel",
        "action.wrong_terminal",
        "SUCCEEDED",
        (_CANCEL, _CANCEL.replace("canceled()", "succeed()")),
    ),
    _slip(
        "cancelled twice",
        "cancel",
        "action.wrong_terminal",
        "succeed() in line",
        (_CANCEL, "                goal_handle.canceled()\n                break\n"),
    ),
    _slip(
        "cancelled without a result",
        "cancel",
        None,
        "nothing was filled in",
        (_CANCEL, "                goal_handle.canceled()\n                return MoveRobot.Result()\n"),
    ),
    _slip(
        "cancelled, and says it is there",
        "cancel",
        None,
        "The last feedback said",
        (
            _CANCEL,
            (
                "                goal_handle.canceled()\n                result = self.result(begin)\n"
                "                result.final_position = goal_handle.request.target\n                return result\n"
            ),
        ),
    ),
    _slip(
        "cancel callback returns True",
        "cancel",
        "action.cancel_refused",
        "will not cancel",
        ("return CancelResponse.ACCEPT", "return True"),
    ),
    _slip(
        "thinks about cancelling",
        "cancel",
        "action.cancel_blocked",
        "not answered before the move was over",
        ("        return CancelResponse.ACCEPT", "        time.sleep(7.0)\n        return CancelResponse.ACCEPT"),
        ("import math\n", "import math\nimport time\n"),
    ),
    _slip(
        "not free after cancelling",
        "after_cancel",
        None,
        "still believes that an earlier one runs",
        (_FREE, "        finally:\n            self.busy = goal_handle.is_active or self.cancelled\n"),
        ("self.busy = False\n        self.server", "self.busy = self.cancelled = False\n        self.server"),
        (_CANCEL, f"                self.cancelled = True\n{_CANCEL}"),
    ),
    _slip(
        "goes home after cancelling",
        "after_cancel",
        None,
        "the way from (0.00, 0.00)",
        (
            _CANCEL,
            (
                "                goal_handle.canceled()\n                result = self.result(begin)\n"
                "                self.robot = SimulatedRobot()\n                return result\n"
            ),
        ),
    ),
)

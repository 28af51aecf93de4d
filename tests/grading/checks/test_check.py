"""The order of checks, and what becomes of one that breaks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest
import yaml

from course_kit.grading.checks.check import Check, choose_part, require_order, run_all
from course_kit.grading.checks.evidence import Evidence, ExchangeLog, Failed
from course_kit.grading.checks.parameters import parameter_file
from course_kit.grading.checks.vocabulary import check

if TYPE_CHECKING:
    from course_kit.grading.checks.vocabulary import GradedNode


class FakeBench:
    def __init__(self) -> None:
        self.record = ExchangeLog()

    def begin(self, deadline_s: float) -> None:
        self.deadline_s = deadline_s

    def see_graph(self) -> None: ...


def make(name: str, *needs: str, outcome: Any = None) -> Check:
    def run(context: Any) -> Evidence:
        del context
        if outcome is not None:
            raise outcome
        return Evidence("a", "b", "c")

    return Check(name, name.title(), 1.0, needs, 1.0, run)


def run(*checks: Check) -> dict[str, str]:
    return {result.id: result.status for result in run_all(checks, FakeBench())}  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("checks", "said"),
    [
        ([make("a", "b"), make("b", "a")], "never run"),
        ([make("a", "missing")], "missing"),
        ([make("a", "b"), make("b")], "a is never run: b does not come before it"),
        ([make("a"), make("a")], "two checks are called a"),
    ],
)
def test_impossible_orders_are_refused(checks: list[Check], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        require_order(checks)


def test_one_part_is_run_with_what_it_needs() -> None:
    checks = [make("offered"), make("found", "offered"), make("door_locked", "found"), make("door"), make("doors")]
    assert [one.id for one in choose_part(checks, "door")] == ["offered", "found", "door_locked", "door"]


def test_failure_skips_what_depends_on_it_and_nothing_else() -> None:
    failed = Failed(Evidence("s", "e", "g"), "what happened", "math.formula")
    checks = make("a", outcome=failed), make("b", "a"), make("c", "b"), make("d")
    assert run(*checks) == {"a": "failed", "b": "skipped", "c": "skipped", "d": "passed"}
    of_c = next(one for one in run_all(checks, FakeBench()) if one.id == "c")  # type: ignore[arg-type]
    assert of_c.message == 'Not run, because "A" did not pass.'  # what failed, not what was not run either


def test_after_a_fault_of_the_grader_nothing_more_is_run() -> None:
    checks = [make("a"), make("b", outcome=ZeroDivisionError()), make("c")]
    assert run(*checks) == {"a": "passed", "b": "error", "c": "skipped"}
    *_, last = run_all(checks, FakeBench())  # type: ignore[arg-type]
    assert 'the grader failed in "B"' in last.message


def test_declaration_takes_name_and_title_from_the_function() -> None:
    @check(points=2, after=["x"], proves=["answers", "in_time"])
    def reaches_the_wall(node: GradedNode) -> None:
        """The robot reaches the wall.

        More about it.
        """
        del node

    assert (reaches_the_wall.id, reaches_the_wall.title) == ("reaches_the_wall", "The robot reaches the wall")
    assert (reaches_the_wall.points, reaches_the_wall.depends_on) == (2.0, ("x",))
    assert reaches_the_wall.proves == ("answers", "in_time")


def test_declaration_needs_a_title_and_points() -> None:
    def silent(node: GradedNode) -> None:
        raise NotImplementedError

    with pytest.raises(ValueError, match="docstring"):
        check(points=1)(silent)
    silent.__doc__ = "Title."
    with pytest.raises(ValueError, match="points"):
        check(points=0)(silent)


def test_what_a_program_is_started_with_are_the_values_that_were_given() -> None:
    values = {
        "texts": ["a banana", "inf", "it's on"],
        "flags": [True, False],
        "far": [math.inf, -math.inf, 1.5],
        "n": 3,
    }
    assert yaml.safe_load(parameter_file(values, "/node")) == {"node": {"ros__parameters": values}}
    assert math.isnan(yaml.safe_load(parameter_file({"x": math.nan}, ""))["/**"]["ros__parameters"]["x"])

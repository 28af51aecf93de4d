"""The small steps of the lessons, in the lessons' order. Each function is one check, its docstring what is right."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.learner.step_check import LessonStep

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.checks.graded_node import GradedNode

ADD = "example_interfaces/srv/AddTwoInts"
PERSON = "my_interfaces/srv/PersonInfo"
STEPS: dict[str, LessonStep] = {}


def step(lesson: str, *needs: str) -> Callable[[Callable[[GradedNode], object]], LessonStep]:
    """Make a check a step of a lesson.

    Args:
        lesson: the notebook's name.
        needs: what has to be on the graph: "service NAME TYPE", the same for an action, a publisher and a
            subscription, or "node NAME".
    """

    def register(ask: Callable[[GradedNode], object]) -> LessonStep:
        made = LessonStep(lesson, ask.__name__, (ask.__doc__ or "").strip(), needs, ask)
        STEPS[made.name] = made
        return made

    return register


@step("01_services", f"service /subtract_two_ints {ADD}")
def subtract(node: GradedNode) -> None:
    """`/subtract_two_ints` answers with `a - b`."""
    node.call("/subtract_two_ints", a=5, b=3).expect(sum=2)
    node.call("/subtract_two_ints", a=3, b=5).expect(sum=-2)


@step("01_services", f"service /person_info {PERSON}")
def greet(node: GradedNode) -> None:
    """`/person_info` answers, because `greet` returns its response."""
    node.call("/person_info", name="Ada", age=36).expect(success=True)


@step("01_services", f"service /person_info {PERSON}")
def too_old(node: GradedNode) -> None:
    """The receptionist refuses an age above 150 and says why."""
    node.call("/person_info", name="Methuselah", age=969).refused()
    node.call("/person_info", name="Ada", age=-1).refused()
    node.call("/person_info", name="Ada", age=150).expect(success=True)


@step("01_services", f"service /triple {ADD}")
def triple(node: GradedNode) -> None:
    """`/triple` answers with three times `a`."""
    node.call("/triple", a=14).expect(sum=42)
    node.call("/triple", a=-2).expect(sum=-6)

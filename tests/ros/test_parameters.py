"""Parameters as values, and what is asked of a node for them."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest
from rclpy.parameter import Parameter

from course_kit.lab import parameters as lab_parameters
from course_kit.ros import parameters
from course_kit.ros.messages import BadFieldError

if TYPE_CHECKING:
    from course_kit.ros.parameters import Question

VALUES = {"flag": True, "count": 3, "speed": 1.5, "name": "r2d2", "gears": [1, 2], "raw": [b"a"], "ends": [True, False]}


class AnswersAsANode:
    """Stands in for the services of a node that has declared some parameters; answers for all or none, as rclpy."""

    def __init__(self) -> None:
        self.asked: list[str] = []
        self.known = {name: parameters.to_message(name, value).value for name, value in VALUES.items()}

    def __call__(self, question: Question) -> Any:
        self.asked.append(question.service)
        response = question.interface.Response()
        if question.service == "list_parameters":
            response.result.names = list(self.known)
        elif question.service == "get_parameter_types":
            response.types = [self.known[name].type for name in question.fields["names"] if name in self.known]
        else:
            known = [self.known.get(name) for name in question.fields["names"]]
            response.values = [] if None in known else known
        return response

    async def later(self, question: Question) -> Any:
        await asyncio.sleep(0)
        return self(question)


@pytest.mark.parametrize(("name", "value"), VALUES.items())
def test_a_value_is_what_rclpy_makes_of_it_and_comes_back(name: str, value: Any) -> None:
    message = parameters.to_message(name, value)
    assert message == Parameter(name, value=value).to_parameter_msg()
    assert parameters.from_message(message.value) == value


@pytest.mark.parametrize("value", [{}, object(), [1, 1.5], [1, "a"], 2**63, [2**63]])
def test_what_no_parameter_can_have_is_named(value: Any) -> None:
    with pytest.raises(BadFieldError, match="'speed' was given"):
        parameters.to_message("speed", value)


def test_the_node_knows_what_an_empty_list_is_a_list_of() -> None:
    messages = parameters.run_steps(
        lab_parameters._make_messages({"gears": [], "new": [], "speed": 2.0}), AnswersAsANode()
    )
    assert [parameters.type_of(one.value) for one in messages] == ["integer_array", "byte_array", "double"]

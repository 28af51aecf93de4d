"""Parameters of another node, asked for through its parameter services ("Parameters" among the ROS 2 concepts)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from course_kit.ros import parameters
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph import visible

if TYPE_CHECKING:
    from course_kit.ros.messages import Message
    from course_kit.ros2cli.graph import Graph
    from course_kit.ros2cli.session import Session

T = TypeVar("T")


class ParameterClient:
    """Asks one node for its parameters."""

    def __init__(self, session: Session, node_name: str, timeout: float) -> None:
        self._session, self._name, self._timeout = session, node_name, timeout

    def ask(self, steps: parameters.Steps[T]) -> T:
        """What one of the verbs of `course_kit.ros.parameters` returns."""
        return parameters.driven(steps, self._answer)

    def declared(self, name: str) -> Message:
        """The ParameterValue of `name`; of type 0 where it is declared without a value."""
        (found,) = self.ask(parameters.values([name]))
        if found.type == 0 and name not in (known := self.ask(parameters.names())):
            raise CommandError(f"Parameter not set: {self._name} has no {name!r}.{did_you_mean(name, known)}")
        return found

    def _answer(self, question: parameters.Question) -> Message:
        from course_kit.ros.service import ServiceClient

        client = ServiceClient(self._session.node, question.interface, f"{self._name}/{question.service}")
        try:
            if not self._session.wait_on_graph(client.is_ready, self._timeout):
                raise CommandError(f"{self._name} offers no parameter services within {self._timeout:g} s.")
            return self._session.answer_of(client, question.request, self._timeout, self._name)
        finally:
            client.destroy()


def nodes_with_parameters(graph: Graph, *, hidden_too: bool = False) -> list[str]:
    """The nodes that have parameter services, in order."""
    names = visible({node: [] for node in graph.nodes}, hidden_too=hidden_too)
    return [node for node in names if f"{node}{parameters.LIST_SERVICE}" in graph.services]


def find_node(name: str, graph: Graph) -> str:
    """The node's full name."""
    if name not in graph.nodes:
        raise CommandError(f"Node not found: {name}.{did_you_mean(name, graph.nodes)}")
    return name


def type_in_words(value: Message) -> str:
    """The type of a value or a descriptor as the real command calls it."""
    return parameters.type_of(value).replace("bool", "boolean").replace("_", " ")


def value_in_words(value: Message) -> str:
    """What `param get` prints before a value."""
    kind = type_in_words(value)
    return f"{kind.removesuffix(' array').capitalize()} {'values are' if 'array' in kind else 'value is'}:"


def plain_value(value: Message) -> object:
    """What a ParameterValue holds for YAML: arrays as lists, bytes as numbers."""
    found = parameters.from_message(value)
    return [one[0] if isinstance(one, bytes) else one for one in found] if isinstance(found, list) else found


def parse(name: str, text: str) -> Message:
    """A parameter from what was typed, by ROS 2's rules: YAML decides the type, a mixed list is a string."""
    from rcl_interfaces.msg import Parameter
    from rclpy.parameter import get_parameter_value
    from yaml import YAMLError

    try:
        return Parameter(name=name, value=get_parameter_value(text))
    except (YAMLError, AssertionError, ValueError, OverflowError) as error:
        raise CommandError(f"{text!r} is not a parameter value: {str(error).splitlines()[0]}.") from error

"""Parameters of another node, asked for through its parameter services ("Parameters" among the ROS 2 concepts)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.ros2cli.errors import CommandError, did_you_mean
from course_kit.ros2cli.graph import visible

if TYPE_CHECKING:
    from course_kit.ros2cli.graph import Graph
    from course_kit.ros2cli.session import Session

# By rcl_interfaces/msg/ParameterType: the name of the type, what `param get` prints, the field with the value.
KINDS = {
    0: ("not set", "Parameter not set", ""),
    1: ("boolean", "Boolean value is:", "bool_value"),
    2: ("integer", "Integer value is:", "integer_value"),
    3: ("double", "Double value is:", "double_value"),
    4: ("string", "String value is:", "string_value"),
    5: ("byte array", "Byte values are:", "byte_array_value"),
    6: ("boolean array", "Boolean values are:", "bool_array_value"),
    7: ("integer array", "Integer values are:", "integer_array_value"),
    8: ("double array", "Double values are:", "double_array_value"),
    9: ("string array", "String values are:", "string_array_value"),
}
PARAMETER_SERVICE = "/list_parameters"


class ParameterClient:
    """Asks one node for its parameters.

    Args:
        session: the command's.
        node_name: full name of the node.
        timeout: seconds to wait for each answer.
    """

    def __init__(self, session: Session, node_name: str, timeout: float) -> None:
        self._session, self._name, self._timeout = session, node_name, timeout

    def names(self, prefixes: list[str] | None = None) -> list[str]:
        """The names of all parameters, in order; with `prefixes` only those below them."""
        answer = self._ask("ListParameters", "list_parameters", prefixes=prefixes or [])
        return sorted(answer.result.names)

    def values(self, names: list[str]) -> list[Any]:
        """The rcl_interfaces/msg/ParameterValue of each name; of type 0 where there is none."""
        return list(self._ask("GetParameters", "get_parameters", names=names).values)

    def descriptors(self, names: list[str]) -> list[Any]:
        """The rcl_interfaces/msg/ParameterDescriptor of each name."""
        return list(self._ask("DescribeParameters", "describe_parameters", names=names).descriptors)

    def set(self, values: dict[str, Any]) -> list[Any]:
        """Set ParameterValues by name; an rcl_interfaces/msg/SetParametersResult for each."""
        from rcl_interfaces.msg import Parameter

        parameters = [Parameter(name=name, value=value) for name, value in values.items()]
        return list(self._ask("SetParameters", "set_parameters", parameters=parameters).results)

    def require(self, name: str) -> Any:
        """The ParameterValue of `name`.

        Raises:
            CommandError: the node has no such parameter.
        """
        found = self.values([name])
        if not found or found[0].type == 0:
            raise self.not_set(name)
        return found[0]

    def not_set(self, name: str) -> CommandError:
        """What to say when there is no parameter of this name."""
        return CommandError(f"Parameter not set: {self._name} has no {name!r}.{did_you_mean(name, self.names())}")

    def _ask(self, type_name: str, service: str, **fields: Any) -> Any:
        import rcl_interfaces.srv

        service_type = getattr(rcl_interfaces.srv, type_name)
        client = self._session.node.create_client(service_type, f"{self._name}/{service}")
        try:
            if not self._session.wait_on_graph(client.service_is_ready, self._timeout):
                raise CommandError(f"{self._name} offers no parameter services within {self._timeout:g} s.")
            request = service_type.Request(**fields)
            return self._session.answer_of(client, request, self._timeout, self._name)
        finally:
            self._session.node.destroy_client(client)


def nodes_with_parameters(graph: Graph, *, hidden_too: bool = False) -> list[str]:
    """The nodes that have parameter services, in order."""
    names = visible({node: [] for node in graph.nodes}, hidden_too=hidden_too)
    return [node for node in names if f"{node}{PARAMETER_SERVICE}" in graph.services]


def find_node(name: str, graph: Graph) -> str:
    """The node's full name.

    Raises:
        CommandError: it is not on the graph; in the words of the real command, with the nearest right name.
    """
    if name not in graph.nodes:
        raise CommandError(f"Node not found: {name}.{did_you_mean(name, graph.nodes)}")
    return name


def value_of(value: Any) -> Any:
    """What a ParameterValue holds, None when it is not set."""
    field = KINDS[value.type][2]
    return getattr(value, field) if field else None


def plain_value(value: Any) -> Any:
    """The same for YAML: arrays as lists, bytes as numbers."""
    held = value_of(value)
    if isinstance(held, (bool, int, float, str)) or held is None:
        return held
    return [element[0] if isinstance(element, bytes) else element for element in held]


def parse(text: str) -> Any:
    """A ParameterValue from what was typed, by ROS 2's rules: YAML decides the type, a mixed list is a string."""
    from rclpy.parameter import get_parameter_value
    from yaml import YAMLError

    try:
        return get_parameter_value(text)
    except (YAMLError, AssertionError, ValueError, OverflowError) as error:
        raise CommandError(f"{text!r} is no value of a parameter: {str(error).splitlines()[0]}.") from error


def load_file(path: str, node: str, *, use_wildcard: bool) -> dict[str, Any]:
    """The ParameterValues for `node` in a parameter file, by name.

    Raises:
        CommandError: the file cannot be read, or has nothing for this node.
    """
    from rclpy.parameter import parameter_dict_from_yaml_file
    from yaml import YAMLError

    # ROS 2 takes /name and name; rclpy's function both from 7.1.8 on, and before that only what is asked for.
    try:
        keys = _top_level(path)
        written = node if node in keys or node[1:] not in keys else node[1:]
        loaded = parameter_dict_from_yaml_file(path, use_wildcard=use_wildcard, target_nodes=[written])
    except OSError as error:
        raise CommandError(f"{path}: {error.strerror}.") from error
    except (RuntimeError, YAMLError, AttributeError, TypeError, ValueError) as error:
        raise CommandError(f"{path} is no parameter file for {node}: {str(error).strip()}") from error
    return {name: parameter.value for name, parameter in loaded.items()}


def _top_level(path: str) -> set[str]:
    from yaml import safe_load

    with open(path, encoding="utf-8") as file:  # noqa: PTH123 - an OSError names what was given
        loaded = safe_load(file)
    return set(loaded) if isinstance(loaded, dict) else set()

"""Parameters of another node, asked for through its parameter services ("Parameters" among the ROS 2 concepts)."""

from __future__ import annotations

import re
import tempfile
from typing import TYPE_CHECKING, Any, TypeVar

from course_kit.ros import parameters
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros.messages import Message

PARAMETERS = "ros__parameters"
_ANY_NUMBER, _ANY_ONE = "**", "*"
_EVERY_NODE = f"/{_ANY_NUMBER}"


def load_parameters(path: str, node: str, *, use_wildcard: bool) -> list[Message]:
    """The parameters for a node in a file of parameters, as rcl_interfaces/msg/Parameter."""
    sections = list(_sections(_document(path), "", path))
    wanted = [pair for pair in sections if _is_for(pair[0], node) and (use_wildcard or _ANY_ONE not in pair[0])]
    if not wanted:
        names = [name for name, _ in sections]
        there = f"It has some for {', '.join(names)}." if names else "It has no parameters at all."
        near = did_you_mean(node, names)
        raise CommandError(f"{path} has no parameters for {node}. {there}{near}")
    together: dict[str, Any] = {}
    for _, values in sorted(wanted, key=lambda section: _ANY_ONE not in section[0]):  # the general ones first
        _merge(together, values)
    return _as_rclpy_reads(together, path)


def _document(path: str) -> dict[Any, Any]:
    from yaml import MarkedYAMLError, YAMLError, safe_load

    try:
        with open(path, encoding="utf-8") as file:  # noqa: PTH123 - an OSError names what was given
            loaded = safe_load(file)
    except OSError as error:
        raise CommandError(f"{path}: {error.strerror}.") from error
    except (YAMLError, ValueError) as error:
        marked = error.problem_mark if isinstance(error, MarkedYAMLError) else None
        place = f" (line {marked.line + 1})" if marked else ""
        problem = (error.problem if isinstance(error, MarkedYAMLError) else None) or str(error).splitlines()[0]
        raise CommandError(f"{path} is not valid YAML: {problem}{place}.") from error
    if not isinstance(loaded, dict):
        raise CommandError(
            f"{path} is not a file of parameters. One looks like `robot: {{{PARAMETERS}: {{speed: 1.0}}}}`."
        )
    return loaded


def _sections(part: dict[Any, Any], name: str, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Pattern and parameters of each section; sections may lie in each other, as namespaces do."""
    for key, value in part.items():
        inner = f"{name}/{str(key).strip('/')}"
        if not isinstance(value, dict):
            raise CommandError(f"{path} is not a file of parameters: there is no {PARAMETERS} under {inner}.")
        if PARAMETERS in value:
            if not isinstance(value[PARAMETERS], dict):
                raise CommandError(f"{path}: {PARAMETERS} of {inner} has to hold names and values.")
            yield inner, value[PARAMETERS]
        yield from _sections({key: rest for key, rest in value.items() if key != PARAMETERS}, inner, path)


def _is_for(pattern: str, node: str) -> bool:
    parts = (re.escape(part) for part in pattern.split("/")[1:])
    whole = "".join(
        r"(?:/\w+)*" if part == re.escape(_ANY_NUMBER) else rf"/{part.replace(re.escape(_ANY_ONE), r'[^/]*')}"
        for part in parts
    )
    return re.fullmatch(whole, node) is not None


def _merge(into: dict[str, Any], values: dict[str, Any]) -> None:
    """Add values; groups of parameters, which are mappings, are merged and not replaced."""
    for name, value in values.items():
        if isinstance(value, dict) and isinstance(into.get(name), dict):
            _merge(into[name], value)
        else:
            into[str(name)] = value


def _as_rclpy_reads(values: dict[str, Any], path: str) -> list[Message]:
    """The parameters as rclpy makes them of such a file, its types included."""
    from rclpy.parameter import parameter_dict_from_yaml_file
    from yaml import safe_dump

    with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8") as file:
        safe_dump({_EVERY_NODE: {PARAMETERS: values}}, file, allow_unicode=True)
        file.flush()
        try:
            return list(parameter_dict_from_yaml_file(file.name, use_wildcard=True).values())
        except (RuntimeError, AttributeError, TypeError, ValueError, AssertionError) as error:
            raise CommandError(f"{path} holds a value that no parameter can have: {str(error).strip()}") from error


T = TypeVar("T")


class ParameterClient:
    """Asks one node for its parameters."""

    def __init__(self, session: Session, node_name: str, timeout: float) -> None:
        self._session, self._name, self._timeout = session, node_name, timeout

    def ask(self, steps: parameters.Steps[T]) -> T:
        """What one of the verbs of `course_kit.ros.parameters` returns."""
        return parameters.run_steps(steps, self._answer)

    def require_declared(self, name: str) -> Message:
        """The ParameterValue of `name`; of type 0 where it is declared without a value."""
        (found,) = self.ask(parameters.ask_values([name]))
        if found.type == 0 and name not in (known := self.ask(parameters.ask_names())):
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

"""Parameters of a node: their values, and what is asked of the services every node has for them.

Each verb is a generator that yields a `Question` for a service and is sent the response. How one waits for that is
the caller's: `run_steps` has a function that waits, and whoever awaits sends the responses by themselves.
"""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from course_kit.ros.messages import BadFieldError, with_article

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Sequence

    from rcl_interfaces.msg import Parameter, ParameterDescriptor, ParameterValue, SetParametersResult

    from course_kit.ros.messages import Message, ServiceType


NOT_SET = "not set"
# By rcl_interfaces/msg/ParameterType; the field of ParameterValue that holds the value is called after the type.
_OF_ARRAYS = ("byte", "bool", "integer", "double", "string")
TYPES = (NOT_SET, "bool", "integer", "double", "string", *(f"{word}_array" for word in _OF_ARRAYS))
_ARRAYS = 5  # the first of them
_ELEMENTS = (bytes, bool, int, float, str)  # of the arrays; from the second on also the types from 1 on
_INT64 = range(-(2**63), 2**63)
LIST_SERVICE = "/list_parameters"  # a node that has it has parameter services
# Every node has these, whatever its author declares.
_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service")
_OVERRIDES = "qos_overrides."

T = TypeVar("T")


class Question(NamedTuple):
    """A call that a verb wants made."""

    service: str
    fields: dict[str, Any]

    @property
    def interface(self) -> ServiceType:
        """The service's class."""
        import rcl_interfaces.srv

        found: ServiceType = getattr(rcl_interfaces.srv, "".join(word.capitalize() for word in self.service.split("_")))
        return found

    @property
    def request(self) -> Message:
        """The request."""
        return self.interface.Request(**self.fields)


if TYPE_CHECKING:
    Steps = Generator[Question, Message, T]


def run_steps(steps: Steps[T], ask: Callable[[Question], Message]) -> T:
    """What a verb returns, each of its questions answered by `ask`."""
    response = None
    try:
        while True:
            response = ask(steps.send(response))
    except StopIteration as end:
        result: T = end.value
        return result


def ask_names(prefixes: Iterable[str] = ()) -> Steps[list[str]]:
    """The names of all parameters as the node lists them; with `prefixes` only those below them."""
    return list((yield Question("list_parameters", {"prefixes": list(prefixes)})).result.names)


def ask_values(wanted: Sequence[str]) -> Steps[list[ParameterValue]]:
    """The rcl_interfaces/msg/ParameterValue of each name; of type 0 where a parameter is not declared or not set."""
    from rcl_interfaces.msg import ParameterValue

    found = list((yield Question("get_parameters", {"names": list(wanted)})).values)
    if len(found) == len(wanted):
        return found
    if len(wanted) == 1:
        return [ParameterValue()]
    one_by_one = []
    for name in wanted:  # rclpy answers for all or for none
        one_by_one += yield from ask_values([name])
    return one_by_one


def ask_descriptors(wanted: Sequence[str]) -> Steps[list[ParameterDescriptor]]:
    """The rcl_interfaces/msg/ParameterDescriptor of each name."""
    found = list((yield Question("describe_parameters", {"names": list(wanted)})).descriptors)
    for name, descriptor in zip(wanted, found, strict=True):
        descriptor.name = name  # rclpy gives all parameters declared with one descriptor object the last one's name
    return found


def set_each(parameters: Sequence[Parameter]) -> Steps[list[SetParametersResult]]:
    """Set parameters (rcl_interfaces/msg/Parameter), each by itself; a SetParametersResult for each."""
    return list((yield Question("set_parameters", {"parameters": list(parameters)})).results)


def set_together(parameters: Sequence[Parameter]) -> Steps[SetParametersResult]:
    """Set parameters, all or none, in this order; one SetParametersResult for all."""
    return (yield Question("set_parameters_atomically", {"parameters": list(parameters)})).result


def to_message(name: str, value: object, empty_list: int | None = None) -> Parameter:
    """The rcl_interfaces/msg/Parameter for a value; None for "not set", which deletes a dynamic one."""
    from rcl_interfaces.msg import Parameter, ParameterValue

    if hasattr(value, "tolist"):  # numpy's, and array.array's, which is what arrays come back as
        value = value.tolist()
    kind = _kind_of(name, value, empty_list or _ARRAYS)
    message = ParameterValue(type=kind)
    if kind:
        setattr(message, f"{TYPES[kind]}_value", list(value) if isinstance(value, (list, tuple)) else value)
    return Parameter(name=name, value=message)


def from_message(value: ParameterValue) -> Any:
    """What an rcl_interfaces/msg/ParameterValue holds, arrays as lists; None when it is not set."""
    found = raw_value(value)
    return list(found) if _ARRAYS <= value.type < len(TYPES) else found


def raw_value(value: ParameterValue) -> Any:
    """The same, arrays as they are."""
    return getattr(value, f"{TYPES[value.type]}_value") if 0 < value.type < len(TYPES) else None


def type_of(value: ParameterValue) -> str:
    """The type of an rcl_interfaces/msg/ParameterValue, also of one whose number has no name."""
    return TYPES[value.type] if value.type < len(TYPES) else f"of the unknown type {value.type}"


def is_of_every_node(name: str) -> bool:
    """Whether ROS 2 declares this parameter, not the node's author."""
    return name in _OF_EVERY_NODE or name.startswith(_OVERRIDES)


def _kind_of(name: str, value: Any, empty_list: int) -> int:
    if value is None:
        return 0
    is_list = isinstance(value, (list, tuple))
    if is_list and not value:
        return empty_list
    first, kinds, items = (_ARRAYS, _ELEMENTS, value) if is_list else (1, _ELEMENTS[1:], [value])
    for number, kind in enumerate(kinds, first):
        if all(isinstance(item, kind) and (kind is bool or not isinstance(item, bool)) for item in items):
            if kind is int and any(item not in _INT64 for item in items):
                raise _explain_unfit(name, items[0], "An integer parameter has 64 bits")
            return number
    if not is_list:
        raise _explain_unfit(name, value, "A parameter is a bool, an int, a float, a str, or a list of one of these")
    hint = ""
    if all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in value):
        hint = f" Write {[float(item) for item in value]!r}."
    raise _explain_unfit(name, value, "All elements of a list have one type: bool, int, float, str or bytes", hint)


def _explain_unfit(name: str, value: object, rule: str, hint: str = "") -> BadFieldError:
    text = textwrap.shorten(repr(value), 60, placeholder="...")
    return BadFieldError(f"{rule}; {name!r} was given {text}, {with_article(type(value).__name__)}.{hint}")

"""Live ROS 2 nodes behind a notebook: start them, call them, see what they say; running a cell again replaces.

Use it as `from course_kit import lab`. All verbs work on the one lab of this process, which starts ROS when it is
first needed and ends it when the process ends. Nothing is simulated: the nodes are on the ROS graph, and `ros2`
in a terminal sees them.
"""

from __future__ import annotations

from course_kit.lab.api import (
    call,
    call_blocking,
    current,
    diagram,
    next_messages,
    nodes,
    others,
    publish,
    record,
    script,
    send_goal,
    send_goal_blocking,
    start,
    stop,
    stop_others,
    stop_script,
    subscribe,
    timeline,
    use,
)
from course_kit.lab.errors import (
    ActionNotFoundError,
    DeadlockError,
    FieldError,
    LabError,
    NoAnswerError,
    NodeNotFoundError,
    ParameterNotFoundError,
    ScriptError,
    ServiceFailedError,
    ServiceNotFoundError,
)
from course_kit.lab.parameters import (
    describe_parameters,
    describe_parameters_blocking,
    get_parameters,
    get_parameters_blocking,
    set_parameters,
    set_parameters_blocking,
)

__all__ = [
    "ActionNotFoundError",
    "DeadlockError",
    "FieldError",
    "LabError",
    "NoAnswerError",
    "NodeNotFoundError",
    "ParameterNotFoundError",
    "ScriptError",
    "ServiceFailedError",
    "ServiceNotFoundError",
    "call",
    "call_blocking",
    "current",
    "describe_parameters",
    "describe_parameters_blocking",
    "diagram",
    "get_parameters",
    "get_parameters_blocking",
    "next_messages",
    "nodes",
    "others",
    "publish",
    "record",
    "script",
    "send_goal",
    "send_goal_blocking",
    "set_parameters",
    "set_parameters_blocking",
    "start",
    "stop",
    "stop_others",
    "stop_script",
    "subscribe",
    "timeline",
    "use",
]


def __dir__() -> list[str]:
    """What Tab offers after `lab.`: what learners use, and no modules."""
    return __all__

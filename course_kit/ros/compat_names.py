"""The table of private and version-bound names: of rclpy, of the classes rosidl generates, of IPython and of nbval.

A feature is here with the names it cannot do without, who of the kit uses them, and what is lost where one of them is
missing. Not here is what rclpy documents, and what Python itself prescribes (`__init__`, `__await__`, `__del__`).

A name is `module:attribute.attribute`. The last attribute may also be one that the methods of a class give to its
objects, or a local variable of a function.
"""

from __future__ import annotations

from typing import NamedTuple

_SERVER = "rclpy.action.server:ActionServer."
_GOAL = "rclpy.action.server:ServerGoalHandle."
_CLIENT = "rclpy.action.client:ActionClient."
_C = "rclpy.impl.implementation_singleton:rclpy_implementation."
_TYPE = "rcl_interfaces.msg:Log.__class__."  # any class that rosidl has generated; rclpy has always loaded this one


class Feature(NamedTuple):
    """Something the kit does with names that a later version of ROS, IPython or nbval may not have."""

    lost: str
    users: tuple[str, ...]
    names: tuple[str, ...]


RECORDING = Feature(
    "lab.diagram() shows no services and topics, lab.timeline() no callbacks, a call learns of a failed callback only "
    "by its timeout, and lab.publish() does not wait for callbacks",
    ("lab/recording/hooks.py", "lab/runtime/executor.py", "lab/runtime/failures.py", "lab/scripts/child_main.py"),
    (
        "rclpy.executors:Executor._take_service",
        "rclpy.executors:Executor._take_client",
        "rclpy.executors:Executor._take_subscription",
        "rclpy.executors:Executor._take_timer",
        "rclpy.executors:Executor._is_shutdown",
        "rclpy.client:Client._lock",
        "rclpy.client:Client._pending_requests",
        "rclpy.client:Client.logger_name",
        "rclpy.publisher:Publisher.logger_name",
        "rclpy.service:Service.logger_name",
        "rclpy.subscription:Subscription.logger_name",
        "rclpy.subscription:Subscription._callback_type",
        "rclpy.task:Future._set_executor",
    ),
)
GOAL_RECORDING = Feature(
    "lab.diagram() shows no goals",
    ("lab/recording/action_hooks.py", "lab/scripts/child_main.py"),
    (
        _CLIENT + "_cancel_goal_async",
        _CLIENT + "_goal_sequence_number_to_goal_id",
        _CLIENT + "_pending_cancel_requests",
        _CLIENT + "_result_sequence_number_to_goal_id",
        _CLIENT + "_node",
        _CLIENT + "_action_name",
        _CLIENT + "_action_type",
        _SERVER + "_execute_goal_request",
        _SERVER + "_execute_cancel_request",
        _SERVER + "_send_result_response",
        _SERVER + "_result_futures",
        _GOAL + "_update_state",
        _GOAL + "_action_server",
        _GOAL + "_goal_handle",
        "rclpy.action.server:GoalEvent",
    ),
)
EXECUTIONS = Feature(
    "An execute callback keeps everything else in the lab waiting, and its errors are shown as rclpy shows them",
    (
        "lab/runtime/actions.py",
        "lab/runtime/execution.py",
        "lab/recording/action_hooks.py",
    ),
    (_SERVER + "_execute_goal", _SERVER + "_node"),
)
GOAL_ENDS = Feature(
    "Clients of a goal are not told when its node is stopped",
    ("lab/runtime/execution.py",),
    (_SERVER + "_goal_handles", _SERVER + "_result_futures", _GOAL + "_update_state", "rclpy.action.server:GoalEvent"),
)
REPLIES = Feature(
    "The answer to a goal may be missed when it comes at once",
    ("lab/runtime/actions.py",),
    (_CLIENT + "_cancel_goal_async", _CLIENT + "_get_result_async"),
)
FEEDBACK = Feature(
    "Feedback that comes faster than callbacks run may be shown late or not at all",
    ("ros/goal.py",),
    (_CLIENT + "_client_handle",),
)
WAITING_FOR_GOALS = Feature(
    "send_goal(), cancel_goal() and get_result() hang inside a callback instead of saying why",
    ("lab/overrides/rclpy_functions.py",),
    (
        _CLIENT + "_cancel_goal",
        _CLIENT + "_cancel_goal_async",
        _CLIENT + "_get_result",
        _CLIENT + "_get_result_async",
    ),
)
DEADLOCKS = Feature(
    "An await that can never end hangs instead of saying why",
    ("lab/overrides/rclpy_functions.py",),
    ("rclpy.client:Client._pending_requests",),
)
PENDING_CALLS = Feature(
    "A call whose server is replaced meanwhile waits for its timeout",
    ("lab/clients.py",),
    ("rclpy.client:Client._pending_requests",),
)
DEFAULT_CONTEXT = Feature(
    "After the lab of this process has ended, another one needs a restart",
    ("lab/runtime/engine.py", "lab/runtime/executor_thread.py"),
    ("rclpy.utilities:g_default_context",),
)
LOG_LINES = Feature(
    "Log lines do not appear under the cells they belong to",
    ("lab/notebook/cells.py",),
    ("rclpy.impl.rcutils_logger:_rclpy", _C + "rclpy_logging_rcutils_log"),
)
CELL_NAMES = Feature(
    "An error in a callback is shown without the number of its cell",
    ("lab/notebook/cells.py",),
    ("IPython.core.compilerop:CachingCompiler.format_code_name",),
)
ERRORS = Feature(
    "Some mistakes are shown in rclpy's words",
    ("lab/clients.py", "lab/runtime/execution.py"),
    (_C + "RCLError",),
)
OWN_TYPES = Feature(
    "Message types of your own may not work",
    ("interfaces/type_support.py", "interfaces/library.py", "interfaces/message_class.py"),
    (
        _TYPE + "_CREATE_ROS_MESSAGE",
        _TYPE + "_CONVERT_FROM_PY",
        _TYPE + "_CONVERT_TO_PY",
        _TYPE + "_DESTROY_ROS_MESSAGE",
        _TYPE + "_TYPE_SUPPORT",
        _TYPE + "__import_type_support__",
        "rcl_interfaces.msg:Log._fields_and_field_types",
        "rcl_interfaces.msg:Log.SLOT_TYPES",
    ),
)
FAST_GRADING = Feature(
    "Grading takes longer",
    ("grading/checks/receiving.py",),
    (_C + "WaitSet", _C + "GuardCondition"),
)
DIAGNOSES = Feature(
    "Reports do not say what a callback has returned instead of a response or a result, or whether it has ended the "
    "program",
    ("grading/sandbox/runner.py", "grading/diagnosis/tracebacks.py"),
    (
        "rclpy.service:Service.send_response.response",
        _SERVER + "_execute_goal.execute_result",
        "rclpy.executors:await_or_execute",
    ),
)
NOTEBOOK_TESTS = Feature(
    "./course test takes long to notice that a notebook's kernel has died",
    ("dev/nbval_plugin.py", "dev/nbval_kernel.py"),
    (
        "nbval.kernel:RunningKernel.await_reply",
        "nbval.kernel:RunningKernel.is_alive",
        "nbval.kernel:RunningKernel.stop",
        "nbval.kernel:RunningKernel.kc",
        "nbval.kernel:RunningKernel.km",
        "nbval.plugin:RunningKernel",
    ),
)

OF_THE_LAB = (
    RECORDING,
    GOAL_RECORDING,
    EXECUTIONS,
    GOAL_ENDS,
    REPLIES,
    FEEDBACK,
    WAITING_FOR_GOALS,
    DEADLOCKS,
    PENDING_CALLS,
    DEFAULT_CONTEXT,
    LOG_LINES,
    CELL_NAMES,
    ERRORS,
    OWN_TYPES,
)
OF_SCRIPTS = (RECORDING, GOAL_RECORDING, EXECUTIONS)
ALL = (*OF_THE_LAB, FAST_GRADING, DIAGNOSES, NOTEBOOK_TESTS)

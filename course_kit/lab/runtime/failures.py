"""Callbacks that fail: whose it is, what went wrong and where, what to write instead, and who hears of it."""

from __future__ import annotations

import contextlib
import inspect
import linecache
import re
import sysconfig
import traceback
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from rclpy.exceptions import InvalidHandle

from course_kit import environment
from course_kit.environment.notebook import defining_line
from course_kit.lab.errors import DeadlockError, InputError, ServiceFailedError, error_text
from course_kit.lab.recording.hooks import WrongResponseError, WrongResultError, failure_text
from course_kit.lab.runtime.describe import is_alive
from course_kit.ros import names
from course_kit.ros.filling import explain_refusal
from course_kit.ros.messages import type_name, with_article
from course_kit.ros.names import short_name

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import CodeType, FrameType

    from rclpy.client import Client
    from rclpy.node import Node
    from rclpy.service import Service
    from rclpy.task import Future

    from course_kit.lab.notebook.output import Output
    from course_kit.lab.recording.hooks import MessageHooks

    Locate = Callable[[str], str | None]

_NOT_THE_LEARNERS = (
    str(environment.PACKAGE),
    *(sysconfig.get_paths()[name] for name in ("stdlib", "platstdlib", "purelib", "platlib")),
    "<frozen",
    "<field ",  # what checks a field of a live interface
)
_SHOWN = "_shown_by_course_kit"  # on an exception: it has been
_REPEATS = 3  # times the same error of the same callback is shown in a row
_ARGUMENTS = re.compile(
    r"(?:(?P<owner>\w+)\.)?(?P<name>\w+)\(\) takes (?P<takes>\d+) positional arguments? but (?P<given>\d+) "
)
_NO_MESSAGE = re.compile(r"Expected <class '[\w.]+\.(?P<type>\w+)'>, got ")
_SUB_MESSAGE = re.compile(r"The '(?P<field>\w+)' field must be a sub message of type '(?P<type>\w+)'")
_FIELD = re.compile(r"The '(?P<field>\w+)' ")
_IN_ROS = re.compile(r"rclpy\b|course_kit\b|\w+\.(msg|srv|action)\._")
_IMPORTS = {
    "Node": "from rclpy.node import Node",
    "lab": "from course_kit import lab",
    "panels": "from course_kit import panels",
    "rclpy": "import rclpy",
}
_UNDECLARED = re.compile(r"undeclared parameter\(s\): (?P<name>\S+)")
_OF_EVERY_NODE = frozenset({"use_sim_time", "start_type_description_service"})
_GIVEN_TO = {  # what rclpy calls a callback with, by the class of what it belongs to
    "Service": ("request", "response"),
    "Subscription": ("message",),
    "Timer": (),
    "CallbackRun": ("goal_handle",),
}


class CallbackRun(NamedTuple):
    """The callback that is running."""

    entity: Any
    node: Node | None
    since: float
    callback: Any = None
    follows: str = ""


class Crash(NamedTuple):
    """What is known about a callback that failed; text only, so that no frame is kept alive."""

    node: str
    callback: str
    error: str
    place: str
    source: str
    advice: str = ""

    def text(self, ending: str) -> str:
        """The message for the notebook; `ending` says what follows from it."""
        who = f"{self.node}: " if self.node else ""
        lines = [f"{who}{self.callback or 'a callback'} {self.error}"]
        if self.place:
            lines.append(f"  {self.place}: {self.source}")
        if self.advice:
            lines.append(f"  {self.advice}")
        return "\n".join([*lines, f"  {ending}", ""])


def own_line(filename: str, number: int, locate: Locate) -> tuple[str, str]:
    """How to call a line of the learner's, and its text."""
    place = locate(filename) or Path(filename).name
    return f"{place}, line {number}", linecache.getline(filename, number).strip()


def is_own(filename: str) -> bool:
    """Whether code of this file is the learner's, not ours, rclpy's or Python's."""
    return not filename.startswith(_NOT_THE_LEARNERS)


def examine(error: BaseException, entity: Any, node: Node | None, locate: Locate) -> Crash:
    """Find out about an error while its traceback is there."""
    frames = list(traceback.walk_tb(error.__traceback__))
    own = [(frame, number) for frame, number in frames if is_own(frame.f_code.co_filename)]
    callback = getattr(entity, "callback", None)
    code = getattr(inspect.unwrap(callback), "__code__", None) if callback else None
    function = getattr(callback, "__name__", "")
    if own and (not function or (code and not is_own(code.co_filename))):
        function = own[0][0].f_code.co_name  # as rclpy calls it for a parameter that is set
    owner = node if node is not None else node_in(error)
    name = owner.get_name() if owner is not None else ""
    if own and not isinstance(error, WrongResponseError):
        place, source = own_line(own[-1][0].f_code.co_filename, own[-1][1], locate)
    else:  # it has not run, or what it returned is wrong
        place, source = _definition(code, locate)
    if isinstance(error, WrongResponseError):
        return Crash(name, function, error.what, place, source)
    if isinstance(error, (DeadlockError, InputError)):
        return Crash(name, function, f"was stopped: {error}", place, source)
    advice = advice_on(error, owner, entity) or (_on_field(error, frames[-1][0]) if frames else "")
    return Crash(name, function, f"raised {failure_text(error)}", place, source, advice)


def where_is(frame: FrameType | None, locate: Locate) -> tuple[str, str] | None:
    """The innermost line of the learner's in a running thread, as `own_line` gives it."""
    while frame is not None:
        if is_own(frame.f_code.co_filename):
            return own_line(frame.f_code.co_filename, frame.f_lineno, locate)
        frame = frame.f_back
    return None


def _definition(code: CodeType | None, locate: Locate) -> tuple[str, str]:
    if code is None or not is_own(code.co_filename):
        return "", ""
    return own_line(code.co_filename, code.co_firstlineno, locate)


class Failures:
    """Hears from the executor of callbacks that fail."""

    def __init__(self, output: Output, locate: Locate, hooks: MessageHooks) -> None:
        self._output = output
        self._locate = locate
        self._hooks = hooks
        self._last_crash: tuple[Crash | None, int] = (None, 0)
        self.latest: dict[str, Crash] = {}  # by the node's name

    def forget(self) -> None:
        """A node is about to be destroyed: the same error of the one in its place is news."""
        self._last_crash = (None, 0)
        self.latest.clear()

    def callback_crashed(self, error: BaseException, turn: CallbackRun) -> None:
        """Say what went wrong in a callback, in three lines; the same error over and over is said three times."""
        if getattr(error, _SHOWN, False):
            return
        with contextlib.suppress(Exception):  # a class of the learner's may allow none
            setattr(error, _SHOWN, True)
        node = turn.node if turn.node not in self._hooks.own_nodes else None
        crash = examine(error, turn if turn.entity is None else turn.entity, node, self._locate)
        if node is not None and not is_alive(node):
            return  # the rest of a node that was stopped in the middle
        self.latest[crash.node] = crash
        before, times = self._last_crash
        times = times + 1 if crash == before else 1
        self._last_crash = (crash, times)
        if times > _REPEATS:
            return
        ending = _consequence(error, turn)
        if times == _REPEATS:
            ending += " (This keeps happening and will not be shown again.)"
        self._output.put(crash.text(ending), "stderr")

    def request_failed(self, turn: CallbackRun | None, service: Service, sequence: int, error: BaseException) -> None:
        """Give the one who waits for this answer an error, if it is a client in this lab."""
        if turn is not None:  # before its caller goes on, so that the two are shown in this order
            self.callback_crashed(error, CallbackRun(service, turn.node, turn.since))
        crash = examine(error, service, None, self._locate)
        owner = short_name(self._hooks.identify(service)[0])
        place = f" ({crash.place})" if crash.place else ""
        text = f"{owner} sent no response: {crash.callback or 'its callback'} {crash.error}{place}"
        found = [_pending(client, service.service_name, sequence) for client in list(self._hooks.clients)]
        waiting = [future for future in found if future is not None]
        if len(waiting) == 1:  # two clients may have used the same number; then each waits for its timeout
            waiting[0].set_exception(ServiceFailedError(text))
            waiting[0].exception()  # marks it as seen: a caller that lost interest is no news


def _pending(client: Client, service: str, sequence: int) -> Future | None:
    """The future of a request. A client holds its lock from sending until there is one: the answer may be sooner."""
    with contextlib.suppress(InvalidHandle), client._lock:  # noqa: SLF001 - it may have been destroyed
        if client.service_name == service:
            return client._pending_requests.get(sequence)  # noqa: SLF001
    return None


def _consequence(error: BaseException, turn: CallbackRun) -> str:
    if turn.follows:
        return turn.follows
    if isinstance(error, DeadlockError):
        return "Nothing hangs here; in a separate program this callback would wait for ever."
    if hasattr(turn.entity, "send_response") or hasattr(turn.entity, "register_goal_callback"):
        return "The caller gets no answer. In a separate program this would end the server; here it keeps running."
    if isinstance(error, WrongResultError):
        return "The client gets an empty result. In a separate program it would wait for ever."
    return "The node keeps running, and so do the others."


def explain_error(error: BaseException, locate: Locate) -> str:
    """What a cell's error is, with the learner's line that led to it; empty where Python's own words say it best."""
    frames = list(traceback.walk_tb(error.__traceback__))
    own = [(frame, number) for frame, number in frames if is_own(frame.f_code.co_filename)]
    if not own:
        return ""
    last = frames[-1][0]
    is_kind = isinstance(error, (TypeError, ModuleNotFoundError, NameError))
    if is_kind and last is own[-1][0] and (advice := advice_on(error)):
        text = failure_text(error)
    elif last is not own[-1][0] and _IN_ROS.match(str(last.f_globals.get("__name__", ""))):
        refusal = _on_field(error, last) or _of_order(error_text(error))
        text = f"{type(error).__name__}: {refusal or error_text(error)}".rstrip()
        advice = "" if refusal else advice_on(error)
    else:
        return ""
    place, source = own_line(own[-1][0].f_code.co_filename, own[-1][1], locate)
    return "\n".join([text, f"  {place}: {source}", *([f"  {advice}"] if advice else [])])


def _on_field(error: BaseException, frame: FrameType) -> str:
    """What a message's field takes that was given something else; empty for any other error."""
    found = _FIELD.match(error_text(error)) if isinstance(error, AssertionError) else None
    inner: FrameType | None = frame
    while found and inner is not None:  # a check may stand below the field itself
        message: Any = inner.f_locals.get("self")
        if hasattr(message, "get_fields_and_field_types"):
            kind = message.get_fields_and_field_types()[found["field"]]
            owner = with_article(type_name(type(message)))
            return explain_refusal(found["field"], inner.f_locals.get("value"), kind, owner)
        inner = inner.f_back
    return ""


def _on_name(name: str, node: Any, frame: FrameType) -> str:
    if not is_own(frame.f_code.co_filename):
        return ""
    if callable(getattr(type(node), name, None)):
        return f"{name} belongs to the node. Write: self.{name}(...)"
    found = defining_line(name, "".join(linecache.getlines(frame.f_code.co_filename)))
    if line := _IMPORTS.get(name) or (found if found.startswith(("from ", "import ")) else ""):
        return f"Write `{line}`{', or run the cell that has it' if found else ''}."
    if found:
        return "A cell of this notebook defines it. Run that cell first."
    there = {**frame.f_globals, **frame.f_locals}
    known = [word for word in there if not word.startswith("_") and word not in ("In", "Out")]
    near = names.nearest_name(name, known)
    return f"Did you mean {near}?" if near else "No cell that has run defines it."


def advice_on(error: BaseException, node: Any = None, entity: Any = None) -> str:
    """A sentence or two; empty where there is nothing to add."""
    text = error_text(error)
    known = of_newer_ros(error) or _of_set_callback(text) or _of_feedback(error) or _of_publish(text)
    if known := known or _of_ros_1(error, text):
        return known
    node = node if node is not None else node_in(error)
    if isinstance(error, TypeError) and (found := _ARGUMENTS.search(text)):
        owner = found["owner"] or ""
        is_callback = not owner or owner in {kind.__name__ for kind in type(node).__mro__}
        return _on_arguments(found["name"], node, entity) if is_callback else _on_unnamed_fields(error, owner)
    if isinstance(error, AssertionError) and (found := _SUB_MESSAGE.search(text)):
        return _on_sub_message(found["field"], found["type"])
    if isinstance(error, NameError) and error.name:
        *_, (frame, _) = traceback.walk_tb(error.__traceback__)
        return _on_name(error.name, node, frame)
    if type(error).__name__ == "ParameterNotDeclaredException" and (found := _UNDECLARED.search(text)):
        return _on_parameter(found["name"].strip("'[]"), node)
    return ""


def of_newer_ros(error: BaseException) -> str:
    """What to say of `with rclpy.init():`, which the examples of newer versions have; empty for any other error."""
    text = error_text(error)
    if not isinstance(error, (TypeError, AttributeError)) or not ("context manager" in text or "__enter__" in text):
        return ""
    lines = [
        linecache.getline(frame.f_code.co_filename, number) for frame, number in traceback.walk_tb(error.__traceback__)
    ]
    if not any("rclpy.init(" in line for line in lines[-1:]):
        return ""
    return (
        "This line belongs to a newer ROS 2. In Jazzy rclpy.init() returns nothing, so `with` cannot use it: write "
        "rclpy.init() on a separate line, and rclpy.try_shutdown() where the block ends."
    )


def _of_set_callback(text: str) -> str:
    """What to write where a node's callback for new values has returned something else than their result."""
    if "Callback returned an invalid type" not in text:
        return ""
    return "End the function of add_on_set_parameters_callback() with `return SetParametersResult(successful=True)`."


def _of_feedback(error: BaseException) -> str:
    """What to write where rclpy has refused feedback, which it does without a word."""
    frame = list(traceback.walk_tb(error.__traceback__))[-1:]
    if error.args or not frame or frame[0][0].f_code.co_name != "publish_feedback":
        return ""
    return "publish_feedback() takes a message of this action's Feedback, made with parentheses: Feedback()."


def _of_publish(text: str) -> str:
    """What to write where rclpy was given something else than a message to send."""
    found = _NO_MESSAGE.match(text)
    return f"Make a message of it: {found['type'].replace('_', '.')}(...)." if found else ""


def _of_ros_1(error: BaseException, text: str) -> str:
    """What to write where a learner follows ROS 1."""
    if isinstance(error, ModuleNotFoundError) and error.name == "rospy":
        return "rospy belongs to ROS 1. ROS 2 has rclpy: notebooks/coming_from_ros_1.md shows both side by side."
    if "missing 1 required positional argument: 'qos_profile'" in text:
        return "The last argument says how many messages may wait to be handled. Write 10."
    return ""


def _of_order(text: str) -> str:
    """What to write where a name was given before its type, as in ROS 1."""
    is_type_a_name = text.startswith("type object 'str' has no attribute '_TYPE_SUPPORT'")
    if not is_type_a_name and not ("rclpy_resolve_name(): incompatible" in text and "<class '" in text):
        return ""
    return "The type comes first, then the name: (Float64, 'speed', ...), not ('speed', Float64, ...)."


def node_in(error: BaseException) -> Any:
    """The node whose method is the innermost in an error's traceback, or None."""
    found = None
    for frame, _ in traceback.walk_tb(error.__traceback__):
        candidate = frame.f_locals.get("self")
        if hasattr(candidate, "get_fully_qualified_name"):
            found = candidate
    return found


def without_self(node_class: type, name: str) -> str:
    """What to say of a method whose first parameter is not self; empty where it is, or nothing is known of it."""
    code: CodeType | None = getattr(getattr(node_class, name, None), "__code__", None)
    if code is None:
        return ""
    parameters = code.co_varnames[: code.co_argcount]
    if parameters[:1] in {("self",), ("cls",)}:
        return ""
    return f"{name}() has no self. Write: def {name}({', '.join(('self', *parameters))}):"


def _on_unnamed_fields(error: BaseException, owner: str) -> str:
    """What to write where a message was given values without their names; empty for any other call."""
    *_, (frame, _) = traceback.walk_tb(error.__traceback__)
    outer, _, part = owner.rpartition("_")  # AddTwoInts_Request is AddTwoInts.Request
    kind: Any = getattr(frame.f_globals.get(outer), part, None) if outer else frame.f_globals.get(part)
    if not hasattr(kind, "get_fields_and_field_types"):
        return ""
    fields = ", ".join(f"{name}=..." for name in kind.get_fields_and_field_types())
    return f"A message takes its values by name: {owner.replace('_', '.')}({fields})."


def _on_arguments(name: str, node: Any, entity: Any) -> str:
    if node is None:
        return ""
    if missing := without_self(type(node), name):
        return missing
    given = _GIVEN_TO.get(type(entity).__name__)
    if given is None:
        return ""
    return f"rclpy calls it with {' and '.join(given) or 'nothing'}. Write: def {name}({', '.join(('self', *given))}):"


def _on_sub_message(field: str, kind: str) -> str:
    examples = {"Point": "x=1.0, y=2.0, z=0.0", "Vector3": "x=1.0, y=2.0, z=0.0", "Quaternion": "w=1.0"}
    example = f"{kind}({examples.get(kind, '...')})"
    return f"{field} is a message itself. Write {example}, or set its fields one by one."


def _on_parameter(name: str, node: Any) -> str:
    if node is None:
        return ""
    declared = node.get_parameters_by_prefix("")  # works for a node that is destroyed, too, as its name does not
    own = [name for name in declared if name not in _OF_EVERY_NODE]
    if not own:
        return f"The node has declared no parameter so far: declare_parameter({name!r}, ...) comes first."
    return f"The node has declared {', '.join(own)}.{names.did_you_mean(name, own)}"

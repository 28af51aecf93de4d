"""The verbs for nodes, services, topics, scripts and the recording."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from course_kit.lab.awaiting import to_be_awaited
from course_kit.lab.errors import LabError

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.qos import QoSProfile

    from course_kit.lab.goals import Goal
    from course_kit.lab.runtime.core import Lab
    from course_kit.lab.runtime.neighbours import OtherNotebook
    from course_kit.lab.runtime.nodes import NodeList
    from course_kit.lab.scripts.running import Script
    from course_kit.lab.topics import Subscription
    from course_kit.ros.messages import ActionType, Message, ServiceType

NodeT = TypeVar("NodeT")


class _Current:
    lab: Lab | None = None


def current() -> Lab:
    """The lab of this process, made on first use."""
    if _Current.lab is None:
        from course_kit.lab.runtime.core import Lab

        _Current.lab = Lab()
    return _Current.lab


def use(lab: Lab | None) -> Lab | None:
    """Make another lab the current one; None for a new one on next use."""
    before, _Current.lab = _Current.lab, lab
    return before


def start(node_class: type[NodeT], /, *args: Any, **kwargs: Any) -> NodeT:
    """Make a node and run it in the background; returns at once.

    Running the cell again replaces the node: the old one is gone before the new one is made. Replaced are nodes
    of the class of the same name if that class was defined again or is started with equal arguments, and any node
    of the same fully qualified ROS name. Started with arguments that give another node name, a class gives a
    second node.

    Args:
        node_class: a class that inherits from rclpy.node.Node, as in any ROS 2 tutorial.
        args: for its `__init__`.
        kwargs: for its `__init__`.

    Returns:
        the node.

    Raises:
        LabError: it is not a node class.
        Exception: whatever `__init__` raises; nothing is left behind then.
    """
    __tracebackhide__ = True  # IPython: the learner's own lines are what matters
    lab = current()
    lab.engine.not_in_callback("lab.start()")
    node: NodeT = lab.engine.nodes.start(node_class, args, kwargs)
    lab.neighbours.node_started(lab.engine.nodes.live[-1:])
    lab.output.drain()
    return node


def stop(target: object = None, /) -> None:
    """Take nodes off the ROS graph: a node, all of a class, one by name, or all of them.

    Without a target it closes the subscriptions of `lab.subscribe`, too.

    Raises:
        LabError: no such node is running.
    """
    lab = current()
    if target is None:
        lab.stop()
        return
    found = lab.engine.nodes.find(target)
    if not found:
        running = ", ".join(live.name.lstrip("/") for live in lab.live_nodes()) or "none"
        name = target.__name__ if isinstance(target, type) else repr(target) if isinstance(target, str) else "This node"
        raise LabError(f"{name} is not running in the lab. Running: {running}.")
    for live in found:
        lab.engine.nodes.stop(live)
    lab.output.drain()


def others() -> list[OtherNotebook]:
    """Other notebooks that have nodes on this graph, by title; a list of their `title` and `nodes`."""
    return current().neighbours.settled_others()


def stop_others() -> None:
    """Have all other notebooks stop their nodes and scripts, and say which these were.

    Raises:
        LabError: one has not stopped them within some seconds.
    """
    current().engine.not_in_callback("lab.stop_others()")
    neighbours = current().neighbours
    found = neighbours.settled_others()
    if left := neighbours.stop(found):
        raise LabError(
            f"{left[0].title} has not stopped its nodes: a callback of theirs does not end. Restart its kernel."
        )
    listed = "; ".join(map(str, found)) or "nothing, for no other notebook has nodes"
    current().engine.note(f"Stopped: {listed}.")


def nodes() -> NodeList:
    """The running nodes, by name; prints as what each serves, calls, publishes and listens to."""
    from course_kit.lab.runtime.nodes import NodeList

    found = NodeList(current().live_nodes())
    found.others = current().neighbours.settled_others()
    return found


@to_be_awaited("lab.call")
async def call(
    service: str, service_type: ServiceType, request: Message = None, /, *, timeout: float = 5.0, **fields: object
) -> Message:
    """Call a service and wait for its response: `await lab.call("/add_two_ints", AddTwoInts, a=1, b=2)`.

    Args:
        service: the service's name.
        service_type: its class.
        request: a ready request instead of `fields`.
        timeout: seconds in which the answer must come; a service that is not on the graph is waited for 2 s of them.
        fields: the request's fields; a dict for a message inside it.

    Returns:
        the response.

    Raises:
        ServiceNotFoundError: no server of this name and type.
        FieldError: no such field, or a value it cannot take.
        ServiceFailedError: the callback of a node in this lab raised or returned no response.
        NoAnswerError: nothing came back in time, or the server went away.
    """
    from course_kit.lab import calls

    engine = current().engine
    engine.not_in_callback("lab.call()")
    return await calls.call_async(calls.ServiceCall(engine, service, service_type, request, fields, timeout))


def call_blocking(
    service: str, service_type: ServiceType, request: Message = None, /, *, timeout: float = 5.0, **fields: object
) -> Message:
    """See `call`; this is the same for programs, which have no `await` at top level."""
    from course_kit.lab import calls

    engine = current().engine
    engine.not_in_callback("lab.call_blocking()")
    return calls.call_blocking(calls.ServiceCall(engine, service, service_type, request, fields, timeout))


def publish(topic: str, message_type: type[Message], message: Message = None, /, **fields: object) -> None:
    """Publish one message: `lab.publish("/chatter", String, data="hello")`.

    Returns when the callbacks of this lab's own subscriptions have had the message (1 s at most).

    Args:
        topic: its name.
        message_type: its class.
        message: a ready message instead of `fields`.
        fields: the message's fields; a dict for a message inside it.

    Raises:
        FieldError: no such field, or a value it cannot take.
    """
    from course_kit.lab import topics

    topics.publish(current().engine, topic, message_type, message, fields)


@to_be_awaited("lab.next_messages", "Nothing was received")
async def next_messages(
    topic: str, message_type: type[Message], count: int = 1, *, timeout: float = 5.0
) -> list[Message]:
    """Subscribe and return the next `count` messages: `await lab.next_messages("/chatter", String, 3)`.

    Args:
        topic: its name.
        message_type: its class.
        count: how many.
        timeout: seconds for all of them.

    Raises:
        NoAnswerError: fewer came within `timeout` seconds.
    """
    from course_kit.lab import topics

    return await topics.next_messages(current().engine, topic, message_type, count, timeout)


def subscribe(
    topic: str, message_type: type[Message], callback: Callable[[Message], None], /, *, qos: QoSProfile | None = None
) -> Subscription:
    """Have a function called with each message of a topic: `lab.subscribe("/chatter", String, print)`.

    Args:
        topic: its name.
        message_type: the message's class.
        callback: called on the lab's thread, so it must be quick and cannot call the lab.
        qos: an rclpy QoSProfile; what the topic's publishers offer at this moment, with a depth of 10, unless given.

    Returns:
        the subscription; it goes on until its `close()`, `lab.stop()`, or the end of the lab.

    Raises:
        FieldError: this is no message type.
        LabError: the topic is no ROS name, or is in use here with another type.
    """
    from course_kit.lab.topics import Subscription

    lab = current()
    return lab.keep(Subscription(lab.engine, topic, message_type, callback, qos))


def script(name: str, source: str, /, *args: object, mode: str = "auto") -> Script:
    """Run an unmodified ROS 2 program as a separate process; what `%%ros_script` does with its cell.

    Args:
        name: what to call it; a script that runs under this name is stopped first.
        source: the program's text.
        args: its command line.
        mode: "wait" returns when it has ended, "background" when it spins, "auto" decides: a program whose nodes
            only call others is waited for, one that serves, subscribes or has a timer goes on in the background.

    Raises:
        ScriptError: the name cannot be a file's name, or the mode is unknown.
    """
    return current().scripts.run(name, source, tuple(str(arg) for arg in args), mode)


def stop_script(name: str | None = None, /) -> None:
    """Stop a script as Ctrl-C would, then by SIGTERM and SIGKILL; all of them without a name.

    Raises:
        ScriptError: no script of this name is running.
    """
    current().scripts.stop(name)


def record() -> None:
    """Begin a new recording; what was recorded is forgotten. `%load_ext course_kit` begins one, too.

    Recorded are the nodes of the lab and the programs of `%%ros_script`, not what others exchange among themselves.
    """
    current().record()


def diagram(*, last: int | None = None) -> object:
    """The recorded exchange as a sequence diagram: a drawing to go through step by step, numbered lines in a terminal.

    Args:
        last: how many of the latest arrows to draw.

    Raises:
        LabError: nothing is being recorded (`%load_ext course_kit` begins it).
    """
    from course_kit.lab.recording.diagram import draw_diagram

    return draw_diagram(current().require_recorder().events, last)


def timeline() -> object:
    """Which thread was inside which callback, from when to when, and what waited to be taken in meanwhile.

    Threads are those of the lab, of its goals, and of the programs that run by `%%ros_script`. A deadlock shows as a
    callback that does not end while the answer it waits for is not taken in.

    Raises:
        LabError: nothing is being recorded (`%load_ext course_kit` begins it).
    """
    from course_kit.lab.recording.timeline import Timeline

    recorder = current().require_recorder()
    return Timeline(recorder.events, recorder.spans)


@to_be_awaited("lab.send_goal")
async def send_goal(  # noqa: PLR0913 - four of them are options, by name
    action: str,
    action_type: ActionType,
    goal: Message = None,
    /,
    *,
    timeout: float = 5.0,
    on_feedback: Callable[[Message], object] | None = None,
    on_result: Callable[[Goal], object] | None = None,
    **fields: object,
) -> Goal:
    """Send a goal and wait until it is accepted or rejected: `await lab.send_goal("/fibonacci", Fibonacci, order=5)`.

    Args:
        action: the action's name.
        action_type: its class.
        goal: a ready goal message instead of `fields`.
        timeout: seconds until the server must have answered; an action that is not on the graph is waited for 2 s.
        on_feedback: called with each feedback message, on the lab's thread.
        on_result: called with the `Goal` when it has ended, on the lab's thread.
        fields: the goal's fields; a dict for a message inside it.

    Returns:
        the goal: `accepted`, `status`, `feedback`, `await goal.result()`, `await goal.cancel()`, and
        `async for feedback in goal`. A rejected goal is one with `accepted` False.

    Raises:
        ActionNotFoundError: no server of this name and type.
        FieldError: no such field, or a value it cannot take.
        NoAnswerError: the server neither accepted nor rejected it in time, or went away.
    """
    from course_kit.lab import calls, goals

    engine = current().engine
    engine.not_in_callback("lab.send_goal()")
    sending = goals.PendingGoal(engine, action, action_type, goal, fields, timeout)
    sent: Goal = await calls.call_async(sending.call_back(on_feedback, on_result))
    return sent


def send_goal_blocking(  # noqa: PLR0913 - the same
    action: str,
    action_type: ActionType,
    goal: Message = None,
    /,
    *,
    timeout: float = 5.0,
    on_feedback: Callable[[Message], object] | None = None,
    on_result: Callable[[Goal], object] | None = None,
    **fields: object,
) -> Goal:
    """See `send_goal`; this is the same for programs, and so are `goal.result_blocking()` and `cancel_blocking()`."""
    from course_kit.lab import calls, goals

    engine = current().engine
    engine.not_in_callback("lab.send_goal_blocking()")
    sending = goals.PendingGoal(engine, action, action_type, goal, fields, timeout)
    sent: Goal = calls.call_blocking(sending.call_back(on_feedback, on_result))
    return sent

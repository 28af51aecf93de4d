"""Why nothing comes back: what is known about a server that keeps its caller waiting."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any, NamedTuple

from course_kit.lab.runtime.callback_errors import where_is
from course_kit.lab.runtime.describe import actions_of
from course_kit.lab.runtime.execution import turn_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.lab.runtime.callback_errors import Locate
    from course_kit.lab.runtime.execution import Executions
    from course_kit.lab.runtime.executor import Turn
    from course_kit.lab.runtime.nodes import LiveNode


class Running(NamedTuple):
    """What runs on a thread of the lab."""

    turn: Turn | None
    thread_id: int
    unfinished: Sequence[Any] = ()


def no_answer(nodes: Iterable[LiveNode], running: Running, service: str, locate: Locate) -> str:
    """What is known about a service's server that does not answer."""
    if running.turn is not None and running.turn.entity is not None:
        return f"{_still_in(running, locate)}; while a callback runs, no other does."
    for live in nodes:
        serving = [one for one in live.node.services if one.service_name == service]
        if any(one is unfinished for one in serving for unfinished in running.unfinished):
            return f"A callback of {live.node.get_name()} for this service has not finished: it awaits something."
        if serving:
            return (
                f"{live.node.get_name()} serves it and none of its callbacks is at work: the request or its response "
                "was lost. Of what waits for a service, or for its client, the newest 10 are kept."
            )
    return (
        "Its server runs outside this notebook; its callback may still be running, or have raised an exception, "
        "or have returned nothing. Look at the server's own output."
    )


def no_result(nodes: Iterable[LiveNode], running: Running, action: str, locate: Locate, executions: Executions) -> str:
    """What is known about an action server that does not answer."""
    if running.turn is not None and running.turn.entity is not None:
        return f"{_still_in(running, locate)}; while a callback runs, no other does."
    for live in nodes:
        if action in actions_of(live.node):
            execution = executions.of(live.node)
            if execution is not None and execution.thread is not None:
                return f"{_still_in(Running(turn_of(execution), execution.thread.ident or 0), locate)}."
            if execution is None:  # a server may have no execute callback, or begin with the goal later
                return f"{live.node.get_name()} has not ended the goal, and no execute callback is running."
            return f"{live.node.get_name()} has not finished the goal: its execute callback awaits something."
    return "Its server runs outside this notebook and may still be busy with the goal. Look at the server's own output."


def _still_in(running: Running, locate: Locate) -> str:
    turn: Any = running.turn
    callback = turn.callback if turn.entity is None else getattr(turn.entity, "callback", None)
    name = getattr(callback, "__name__", "a callback")
    frame = sys._current_frames().get(running.thread_id)  # noqa: SLF001 - the documented way to look
    at = where_is(frame, locate)
    where = f" ({at[0]}: {at[1]})" if at else ""
    owner = turn.node.get_name() if turn.node is not None else "a node"
    return f"{owner} has been in {name}{where} for {time.monotonic() - turn.since:.0f} s"

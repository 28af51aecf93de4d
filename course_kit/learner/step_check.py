"""Small steps of a lesson: what a learner writes in five minutes, and the check that asks the running node about it."""

from __future__ import annotations

import sys
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from course_kit import lab
from course_kit.grading.checks import discovery
from course_kit.grading.checks.context import CheckContext
from course_kit.grading.checks.discovery import WantedEndpoint
from course_kit.grading.checks.evidence import GRADER, Evidence, Failed
from course_kit.grading.checks.graded_node import GradedNode
from course_kit.grading.checks.parameters import RemoteParameters
from course_kit.grading.model.job import Job
from course_kit.grading.model.limits import Limits
from course_kit.grading.model.plain_data import convert_record
from course_kit.learner import progress
from course_kit.ros import graph
from course_kit.ros.names import is_hidden, short_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence


_APPEARS_S = 2.0  # within which what a step needs has to be on the graph
_MOST_S = 20.0  # for all that one check asks
_OF_OTHERS = "lab.stop_others() stops those of other notebooks."


@dataclass(frozen=True)
class LessonStep:
    """One small thing to write."""

    lesson: str  # the notebook, such as "01_services"
    name: str  # what `%check` calls it
    title: str  # what the node does once it is right
    needs: tuple[str, ...]  # what has to be on the graph, each "KIND NAME TYPE", or "node NAME"
    ask: Callable[[GradedNode], object]  # the check


@dataclass(frozen=True)
class StepResult:
    """What a check has found, in words."""

    passed: bool
    text: str

    def __repr__(self) -> str:
        return self.text


def check_step(step: LessonStep) -> StepResult:
    """Ask the nodes on this process's ROS graph about a step, and count the try in the learner's progress."""
    ends = [_endpoint(need) for need in step.needs if not need.startswith("node ")]
    job = Job("", "attach", seed=1, limits=Limits(start_s=_APPEARS_S), endpoints=tuple(ends))
    context = CheckContext(None, job)  # type: ignore[arg-type]  # nothing is started, so nobody starts it
    lab.current().engine.failures.forget()
    try:
        context.begin(_MOST_S)
        context.launch()
        try:
            for need in step.needs:
                _require(need, context)
            step.ask(GradedNode(context))
        except Failed as failed:
            seen = failed.evidence
            parts = (("expected", seen.expected), ("found", seen.got))
            lines = _exchange(context, seen, failed.message) or [f"  {name}: {one}" for name, one in parts if one]
            notes = [f"  {note}" for note in _describe_crashes() + _describe_old_nodes()]
            result = StepResult(passed=False, text="\n".join([f"Not yet: {failed.message}", *notes, *lines]))
        except lab.LabError as failed:  # the lab has seen why a callback of its nodes answers nothing
            result = StepResult(passed=False, text=f"Not yet: {' '.join(_describe_crashes()) or failed}")
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is no fault of the learner's node
            why = f"{type(problem).__name__}: {problem}"
            result = StepResult(passed=False, text=f"The check itself failed ({why}). This is not your fault.")
        else:
            result = StepResult(passed=True, text="\n".join([f"Right: {step.title}", *_exchange(context, Evidence())]))
    finally:
        context.close()
    count = partial(progress.count_try, passed=result.passed)
    trouble = progress.update_progress(f"{step.lesson}/{step.name}", count)
    return replace(result, text="\n".join(filter(None, (result.text, trouble))))


def _describe_crashes() -> list[str]:
    """Which callbacks of the lab's nodes have failed meanwhile; why, and in which line, stands above the result."""
    lab.current().output.drain()
    latest = lab.current().engine.failures.latest.values()
    return [f"{crash.callback or 'a callback'} of {crash.node} failed; the lines above say why." for crash in latest]


def _describe_old_nodes() -> list[str]:
    """Which running nodes are of a class that a cell has defined anew since."""
    defined = vars(sys.modules["__main__"])
    running = [(short_name(live.name), live.node_class.__name__, live.node_class) for live in lab.nodes()]
    return [
        f"{node} runs an older class {name}: lab.start({name}) starts the one that you have defined since."
        for node, name, node_class in running
        if defined.get(name, node_class) is not node_class
    ]


def _endpoint(need: str) -> WantedEndpoint:
    return convert_record(dict(zip(("kind", "name", "type"), need.split(), strict=True)), WantedEndpoint)


def _require(need: str, context: CheckContext) -> None:
    """Fail with what is there instead, unless there is what the step asks about."""
    node, kind, name = context.grader_node, *need.split()[:2]
    if kind == "node":
        remote = RemoteParameters(context, name)
        _await(context, remote.is_ready, need, lambda: [name for name in node.nodes() if not is_hidden(name)])
        return
    end = _endpoint(need)
    if end.is_server:
        ready = partial(end.is_ready, node)
        _await(context, ready, need, lambda: [f"{name} [{found}]" for name, found in node.offers(kind)])
    else:
        discovery.expect_endpoints(context, [end])
    if kind != "subscription":
        _require_only_one(context, end)


def _require_only_one(context: CheckContext, end: WantedEndpoint) -> None:
    """Fail where a node of another notebook answers or publishes as well; one that was replaced goes by itself."""
    node = lab.current().engine.node  # which has known the graph for long
    count = partial(graph.count_servers, node, end.kind) if end.is_server else partial(graph.count_publishing, node)
    if not context.wait_until(lambda: count(end.name) < 2, _APPEARS_S):  # noqa: PLR2004 - two are one too many
        uses = [use for live in lab.nodes() for use in graph.uses_of(node, live.name) if use.role.offers]
        own = [short_name(use.node) for use in uses if use.channel == end.name]
        way = f'Yours are {", ".join(own)}: lab.stop("{own[0]}") stops one.' if own[1:] else _OF_OTHERS
        does = "publish" if end.kind == "publisher" else f"have the {end.kind}"
        why = f"{count(end.name)} nodes {does} {end.name}, and the check asks one. {way}"
        raise Failed(Evidence(), why)


def _await(
    context: CheckContext, condition: Callable[[], bool], need: str, offered: Callable[[], Sequence[str]]
) -> None:
    if context.wait_until(condition, _APPEARS_S):
        return
    there = offered()  # asked now: at first nothing has been discovered
    kind, name, *interface = need.split()
    found = f"on the graph: {', '.join(there) or 'none'}"
    of_type = f" of type {interface[0]}" if interface else ""
    wanted = {end.name for end in context.job.endpoints}  # no other of these is a misspelt one
    near = discovery.name_nearest(name, [one.partition(" ")[0] for one in there if one.partition(" ")[0] not in wanted])
    why = f"No {kind} {name}{of_type} is there.{near}"
    raise Failed(Evidence("", "", found), why)


def _exchange(context: CheckContext, seen: Evidence, message: str = "") -> list[str]:
    """What was sent and what came, one a line; not what the message above it has said."""
    lines = []
    for arrow in context.record.steps(seen):
        if arrow.kind == "failure" and arrow.text in message:
            continue
        mark = "  " if arrow.sender == arrow.receiver else "->" if arrow.sender == GRADER else "<-"
        lines.append(f"  {mark} {arrow.text.rstrip(': ')}")
    return lines

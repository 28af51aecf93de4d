"""What the graph holds instead of what was looked for, in words for the learner."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.diagnosis import exits, hangs
from course_kit.ros.names import nearest_name

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.checks.context import CheckContext


_MOST = 200  # names that are compared
_VAGUELY = 0.3  # how alike two names are at least: whatever there is beside what was looked for is of interest
_MOST_LISTED = 20


def why_empty(context: CheckContext, wanted: str) -> exits.Cause:
    """Why no node has appeared, although the program runs.

    Args:
        context: the context of the check.
        wanted: the full name of what a node was to bring: a service, an action, itself.
    """
    if context.job.mode == "attach":
        return "start.nothing", f"No node on ROS domain {context.grader_node.domain} offers {wanted}."
    doing = hangs.doing(context)
    where = f" It is in {exits.source_line(context.job, doing.own.line)}." if doing.own else ""
    if context.computed() >= context.job.start_cpu_s:
        computed = f"{context.job.start_cpu_s:g} s"
        return "limit.time", f"Your program has computed for {computed} and no node has appeared.{where}"
    start = f"{min(context.job.limits.start_s, context.deadline_s):g} s"
    if hangs.computes(context):
        return "limit.time", f"After {start} your program was still computing and no node had appeared.{where}"
    return "start.nothing", f"Your program runs, but no node appeared on the graph within {start}.{where}"


def closest(wanted: str, names: Sequence[str]) -> str:
    """A sentence that names what comes nearest to `wanted`, with a space before it; nothing without names."""
    near = nearest_name(wanted, names[:_MOST], _VAGUELY) or next(iter(names), "")
    return f" The closest is {near}." if near else ""


def listed(names: Sequence[str], what: str) -> str:
    """`the nodes /a, /b`, or `no node`; of very many the first."""
    told = ", ".join(names[:_MOST_LISTED])
    if len(names) > _MOST_LISTED:
        told += f" and {len(names) - _MOST_LISTED} more"
    return f"the {what}{'s' if len(names) > 1 else ''} {told}" if names else f"no {what}"

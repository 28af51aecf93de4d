"""What the graph holds instead of what was looked for, in words for the learner."""

from __future__ import annotations

import difflib
from typing import TYPE_CHECKING

from course_kit.grading import endings, silence

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.grading.bench import Bench


_LONGEST, _MOST = 100, 200  # names that are compared: it takes the product of their lengths
_MOST_LISTED = 20


def why_empty(bench: Bench, wanted: str) -> endings.Cause:
    """Why no node has appeared, although the program runs.

    Args:
        bench: the test bench.
        wanted: the full name of what a node was to bring: a service, an action, itself.
    """
    if bench.job.mode == "attach":
        return "start.nothing", f"Nobody on the graph of ROS domain {bench.tester.domain} offers {wanted}."
    doing = silence.doing(bench)
    where = f" It is in {endings.source_line(bench.job, doing.own.line)}." if doing.own else ""
    if bench.computed() >= bench.job.start_cpu_s:
        computed = f"{bench.job.start_cpu_s:g} s"
        return "limit.time", f"Your program has computed for {computed}, and no node has appeared.{where}"
    start = f"{bench.job.limits.start_s:g} s"
    if silence.computes(bench):
        return "limit.time", f"After {start} your program was still computing, and no node had appeared.{where}"
    return "start.nothing", f"Your program runs, but within {start} no node has appeared on the graph.{where}"


def closest(wanted: str, names: Sequence[str]) -> str:
    """A sentence that names what comes nearest to `wanted`, with a space before it; nothing without names."""
    short = [name for name in names if len(name) <= _LONGEST][:_MOST]
    close = difflib.get_close_matches(wanted, short, n=1, cutoff=0.3) or list(names)[:1]
    return f" The closest is {close[0]}." if close else ""


def listed(names: Sequence[str], what: str) -> str:
    """`the nodes /a, /b`, or `no node`; of very many the first."""
    told = ", ".join(names[:_MOST_LISTED])
    if len(names) > _MOST_LISTED:
        told += f" and {len(names) - _MOST_LISTED} more"
    return f"the {what}{'s' if len(names) > 1 else ''} {told}" if names else f"no {what}"

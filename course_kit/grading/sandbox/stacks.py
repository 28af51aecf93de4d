"""Asks a sandbox what each thread of its program is executing."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from course_kit.grading.sandbox import init_process

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.grading.sandbox.output_collector import OutputCollector
    from course_kit.grading.sandbox.sandbox import Sandbox

_DUMP_S = 3.0  # how long a dump of stacks is waited for: a submission may have turned it off


def dump(
    sandbox: Sandbox,
    collector: OutputCollector,
    pump_until: Callable[[Callable[[OutputCollector], bool], float], None],
) -> str:
    """The stacks, by faulthandler; empty when none come."""
    collector.forget_stacks()
    began = time.monotonic()
    sandbox.ask(init_process.STACKS)
    pump_until(lambda collector: collector.evidence_bytes > 0 or collector.over, _DUMP_S)
    # Nothing marks a dump's end, and a busy machine may halt it half-way. A second one begins when it is whole.
    sandbox.ask(init_process.STACKS)
    pump_until(lambda collector: collector.has_whole_dump() or collector.over, began + _DUMP_S - time.monotonic())
    size = -1

    def is_quiet(collector: OutputCollector) -> bool:
        nonlocal size
        before, size = size, collector.evidence_bytes
        return size == before

    # The rest of the second, which would be in the next one's way; a submission can go on writing for ever.
    pump_until(is_quiet, began + _DUMP_S - time.monotonic())
    return collector.stacks()

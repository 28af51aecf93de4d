"""Makes nbval end kernels as Jupyter does, and notice at once when one has died.

It leaves pictures out of the comparison: the HTML of panels and diagrams holds style sheets and measured times. The
words that each brings along, as text/plain, are compared. Steps of a lesson are run with their solutions in place.
"""

from __future__ import annotations

import math
import os
import time
from contextlib import ExitStack, suppress
from queue import Empty
from typing import TYPE_CHECKING
from unittest import mock

import nbval.kernel
import nbval.plugin
import pytest

from course_kit import environment
from course_kit.dev import lesson_steps

if TYPE_CHECKING:
    from collections.abc import Generator

CELL_TIMEOUT_S = 60.0  # a cell that waits longer than this hangs; nbval's own default is 2,000 s
OUTPUT_TIMEOUT_S = 60.0  # until the next output comes once a cell has ended; nbval's own 5 s fail on a busy machine
_PICTURE = "text/html"
_POLL_S = 1.0


class CourseKernel(nbval.kernel.RunningKernel):  # type: ignore[misc]  # it has no types
    """A kernel on a ROS graph that nobody else has, which is asked to end and whose death ends the wait for it."""

    def __init__(self, *arguments: object, **options: object) -> None:
        self._graph = ExitStack()
        domain_id = self._graph.enter_context(environment.exclusive_domain())
        # What says that pytest runs would silence what native libraries of the kernel print, and its width of a
        # terminal would break lines.
        changes = dict.fromkeys(("PYTEST_CURRENT_TEST", "COLUMNS", "LINES"))
        changes |= {"ROS_DOMAIN_ID": str(domain_id), "COURSE_KIT_PROGRESS": "off"}
        with mock.patch.dict(os.environ, environment.child_environment(**changes), clear=True):
            super().__init__(*arguments, **options)

    def await_reply(self, msg_id: str, timeout: float | None = None) -> None:
        """Wait for the reply in short steps, looking each time whether the kernel still lives."""
        ends = math.inf if timeout is None else time.monotonic() + timeout
        while True:
            with suppress(Empty):
                super().await_reply(msg_id, timeout=_POLL_S)
                return
            if not self.is_alive():
                raise RuntimeError("The kernel has died while it ran this cell.")
            if time.monotonic() > ends:
                raise Empty

    def stop(self) -> None:
        """Ask the kernel to end; only one that does not is killed."""
        self.kc.stop_channels()
        try:
            self.km.shutdown_kernel(now=False)
        finally:
            del self.km
            self._graph.close()


nbval.kernel.RunningKernel = CourseKernel
nbval.plugin.RunningKernel = CourseKernel


@pytest.hookimpl(wrapper=True)
def pytest_collect_file() -> Generator[None, object, object]:
    """Have nbval compare all of a notebook but its pictures."""
    found = yield
    for collector in found if isinstance(found, list) else [found]:
        if isinstance(collector, nbval.plugin.IPyNbFile):
            collector.skip_compare = (*collector.skip_compare, _PICTURE)
    return found


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector: pytest.Collector) -> Generator[None, pytest.CollectReport, object]:
    """Solve the steps of a notebook once its cells are collected, what they print is not stored; wait for outputs."""
    report = yield
    if isinstance(collector, nbval.plugin.IPyNbFile):
        solved = [id(cell) for step in lesson_steps.solve_steps(collector.nb) for cell in (step.empty, step.check)]
        for item in report.result:
            if isinstance(item, nbval.plugin.IPyNbCell):
                item.output_timeout = OUTPUT_TIMEOUT_S
                if id(item.cell) in solved:
                    item.options["check"] = False
    return report

"""Makes nbval end kernels as Jupyter does, and notice at once when one has died.

nbval kills its kernels, so that nothing they registered for their end would run; and it waits the whole cell
timeout for a kernel that is no more. Loaded with `-p course_kit.dev.nbval_plugin`.

It also leaves pictures out of the comparison, as nbval itself does those in PNG: the HTML of panels, diagrams and time
lines holds style sheets and measured times. The words that each brings along, as text/plain, are compared.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import nbval.kernel
import nbval.plugin
import pytest

from course_kit.ros import compat

if TYPE_CHECKING:
    from collections.abc import Generator

_PICTURE = "text/html"
_found = compat.check([compat.NOTEBOOK_TESTS])
if _found.has(compat.NOTEBOOK_TESTS):
    from course_kit.dev.nbval_kernel import CourseKernel

    nbval.kernel.RunningKernel = CourseKernel
    nbval.plugin.RunningKernel = CourseKernel
else:
    sys.stderr.write("\n".join(_found.sentences()) + "\n")


@pytest.hookimpl(wrapper=True)
def pytest_collect_file() -> Generator[None, object, object]:
    """Have nbval compare all of a notebook but its pictures."""
    found = yield
    for collector in found if isinstance(found, list) else [found]:
        if isinstance(collector, nbval.plugin.IPyNbFile):
            collector.skip_compare = (*collector.skip_compare, _PICTURE)
    return found

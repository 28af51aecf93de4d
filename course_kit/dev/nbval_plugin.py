"""Makes nbval end kernels as Jupyter does, and notice at once when one has died.

nbval kills its kernels, so that nothing they registered for their end would run; and it waits the whole cell
timeout for a kernel that is no more. Loaded with `-p course_kit.dev.nbval_plugin`.
"""

from __future__ import annotations

import sys

import nbval.kernel
import nbval.plugin

from course_kit.ros import compat, compat_names

_found = compat.check([compat_names.NOTEBOOK_TESTS])
if _found.has(compat_names.NOTEBOOK_TESTS):
    from course_kit.dev.nbval_kernel import CourseKernel

    nbval.kernel.RunningKernel = CourseKernel
    nbval.plugin.RunningKernel = CourseKernel
else:
    sys.stderr.write("\n".join(_found.sentences()) + "\n")

"""Records what crosses between nodes and draws it.

`attach()` has the lab report to a recording; `%load_ext course_kit` does it in a notebook. From then on
`lab.diagram()` draws what was recorded and `lab.record()` begins anew. Nodes of the lab and the programs of
`%%ros_script` are seen; what other programs on the graph exchange among themselves is not.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.lab.recording.recording import Recording

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

__all__ = ["Recording", "attach"]


def attach(lab: Lab | None = None) -> Recording:
    """Record from now on, in the given lab or the current one."""
    from course_kit import lab as labs

    target = lab or labs.current()
    if target.recorder is None:
        target.record(Recording())
    return target.require_recorder()

"""ROS 2 course kit.

In a notebook `%load_ext course_kit` makes the course's magics known, puts the kernel on the course's ROS graph and
begins to record what crosses between nodes. Importing the package does nothing else.
"""

from __future__ import annotations

TYPE_CHECKING = False  # every Python of the environment passes here; importing typing would take 5 ms
if TYPE_CHECKING:
    from IPython.core.interactiveshell import InteractiveShell


def load_ipython_extension(shell: InteractiveShell) -> None:
    """Called by `%load_ext course_kit`, which a learner runs again with the notebook's first cell."""
    if "GradeMagics" in shell.magics_manager.registry:
        return
    import os
    import sys

    from course_kit import environment
    from course_kit.grading.model import exercise_folders
    from course_kit.integrations.magics import register_magics
    from course_kit.interfaces.sources import PATH_VARIABLE

    register_magics(shell)
    # Of what is in `loaded`, IPython says at each later `%load_ext` that it is loaded already.
    shell.events.register("post_run_cell", lambda _: shell.extension_manager.loaded.discard(__name__))
    environment.paths.put_scripts_first()  # !ros2, %%bash and subprocess find the programs of this Python
    if path := exercise_folders.interface_path():  # of exercises that bring their types
        os.environ[PATH_VARIABLE] = path
    environment.choose_graph(os.environ.get("JPY_SESSION_NAME", ""))
    environment.apply_settings()  # before rclpy is imported; grading works also where this finds no ROS domain
    if reason := environment.middleware.explain_middleware():
        sys.stderr.write(f"{reason}\n")
    from course_kit import lab

    lab.current().notebook.watch_output()
    lab.record()

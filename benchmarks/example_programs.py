"""What becomes of ROS 2's own example programs: `python benchmarks/example_programs.py WORKSPACE [--only WORD]`.

WORKSPACE is a folder whose `src` holds clones of ros2/examples and ros2/demos (branch jazzy). Each program of the
packages in rclpy/ and demo_nodes_py/ is run unmodified, beside the program it needs: by `ros2 run`, and as a
`%%ros_script` cell. It works when it prints what it is there for; Ctrl-C ends it. The table names what does not.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

from programs import ROS2, Program
from tutorial_workspace import make_stand_ins

from course_kit import environment
from course_kit.launch import package_index

LIMIT_S = 40.0
SAVED = "measured_"  # begins the names under which the cells are saved
QUIET_S = 4.0  # without a traceback are enough for a program that prints nothing
CELL = """
import sys, time
from pathlib import Path
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
shell.run_line_magic("load_ext", "course_kit")
shell.run_cell_magic("ros_script", sys.argv[1] + " " + " ".join(sys.argv[3:]), Path(sys.argv[2]).read_text())
from course_kit import lab
while True:
    time.sleep(0.1)
    lab.current().output.drain()
    sys.stdout.flush()
"""


class Example(NamedTuple):
    """A kind of programs.

    Attributes:
        programs: a pattern of "package executable".
        wanted: a pattern of what one prints when it works; empty when it prints nothing.
        partner: what has to run beside it; a stand-in where that is compiled.
    """

    programs: str
    wanted: str
    partner: str = ""


SERVICE, SERVER = "examples_rclpy_minimal_service service", "examples_rclpy_minimal_action_server server"
TALKER = "demo_nodes_py talker"
EXAMPLES = (
    Example(r".*minimal_client client.*", r"[Rr]esult of add_two_ints.*: ?42|41 \+ 1 = 42|= 42", SERVICE),
    Example(r".*minimal_service .*", r"[Ii]ncoming request", "examples_rclpy_minimal_client client_async"),
    Example(r".*action_client client_cancel", r"Goal successfully canceled", SERVER),
    Example(r".*action_client .*", r"Goal succeeded! Result: ", SERVER),
    Example(r".*action_server .*", r"[Rr]eturning result", "examples_rclpy_minimal_action_client client"),
    Example(r".*guard_conditions .*", r"guard callback called shutdown"),
    Example(r".*minimal_publisher .*", r"Publishing: \"Hello World: 3\""),
    Example(
        r".*minimal_subscriber .*",
        r"I heard: \"Hello World",
        "examples_rclpy_minimal_publisher publisher_local_function",
    ),
    Example(r".*pointcloud_publisher .*", ""),
    Example(r".*executors (listener)", r"I heard", "examples_rclpy_executors talker"),
    Example(r".*executors callback_group", r"Publishing: \"Hello World: 3"),
    Example(r".*executors custom_callback_group", r"I heard|Publishing|Hello World: 3"),
    Example(r".*executors custom_executor", r"I heard|Estop|Hello World", "examples_rclpy_executors talker"),
    Example(r".*executors .*", r"Publishing|Hello World"),
    Example(r".*demo_nodes_py listener_qos", r"I heard", "demo_nodes_py talker_qos"),
    Example(r".*demo_nodes_py listener.*", r"I heard", TALKER),
    Example(r".*demo_nodes_py talker.*", r"Publishing: .*Hello World: 2"),
    Example(r".*demo_nodes_py add_two_ints_server", r"Incoming request", "demo_nodes_py add_two_ints_client_async"),
    Example(r".*demo_nodes_py add_two_ints_.*", r"Result of add_two_ints: 5", "demo_nodes_py add_two_ints_server"),
    Example(
        r".*demo_nodes_py async_param_client",
        r"Deleting parameters:(.|\n)*reason",
        "demo_nodes_cpp parameter_blackboard",
    ),
    Example(r".*demo_nodes_py set_parameters_callback", ""),
    Example(r".*demo_nodes_py introspection", r"Result of add_two_ints"),
    Example(r".*demo_nodes_py matched_event_detect", r"Last publisher is disconnected"),
    Example(r".*demo_nodes_py use_logger_service", r"Output with error logger level:(.|\n)*Current logger level"),
)


def programs_in(workspace: Path) -> dict[str, Path]:
    """The file of each program, by its package and its executable."""
    found = {}
    for folder in sorted(description.parent for description in workspace.rglob("package.xml")):
        for name, (module, _) in package_index.programs(folder).items():
            found[f"{module.partition('.')[0]} {name}"] = folder / f"{module.replace('.', '/')}.py"
    return found


def result(command: list[str], example: Example, workspace: Path, environ: dict[str, str]) -> str:
    """What comes of a program beside its partner."""
    with environment.exclusive_domain() as domain:
        own = environment.child_environment(ROS_DOMAIN_ID=str(domain), PYTHONUNBUFFERED="1", **environ)
        partner = Program([*ROS2, "run", *example.partner.split()], workspace, own) if example.partner else None
        program = Program(command, workspace, own)
        try:
            if example.wanted:
                works = program.prints(example.wanted, LIMIT_S)
            else:
                works = not program.prints("Traceback", QUIET_S) and program.is_running()
        finally:
            program.stop()
            if partner is not None:
                partner.stop()
    if works:
        return "works"
    missing = re.search(r"ModuleNotFoundError: No module named '(\w+)", program.output)
    return f"needs {missing[1]}" if missing else f"fails: {program.output.strip()[-400:] or 'prints nothing'}"


def main() -> None:
    workspace, only = Path(sys.argv[1]).resolve(), sys.argv[3] if sys.argv[2:3] == ["--only"] else ""
    rows: dict[str, list[str]] = {}
    with tempfile.TemporaryDirectory() as folder:
        cell = Path(folder) / "cell.py"
        cell.write_text(CELL)
        make_stand_ins(Path(folder) / "src")
        for name, file in programs_in(workspace).items():
            example = next((one for one in EXAMPLES if re.fullmatch(one.programs, name)), None)
            if example is None or only not in name:
                continue
            environ = {"COURSE_KIT_PACKAGE_PATH": str(Path(folder) / "src")}
            by_run = result([*ROS2, "run", *name.split()], example, workspace, environ)
            root = next(folder for folder in file.parents if (folder / "package.xml").is_file())
            environ["PYTHONPATH"] = str(root)  # this and the next line: as if pip had installed it
            package_index.make_known([root])
            in_a_cell = result(
                [sys.executable, str(cell), f"{SAVED}{name.split()[1]}", str(file)], example, workspace, environ
            )
            rows[name] = [by_run, in_a_cell]
            print(name, by_run, in_a_cell, sep=" | ", flush=True)
    for saved in (environment.run_dir() / "scripts").glob(f"{SAVED}*.py"):
        saved.unlink()  # else `ros2 run` would find it by its name
    print(f"\n| {len(rows)} programs | by `ros2 run` | in a `%%ros_script` cell |\n|---|---|---|")
    for name, cells in rows.items():
        print(f"| `{name}` | " + " | ".join(" ".join(text.split())[-120:] for text in cells) + " |")


if __name__ == "__main__":
    main()

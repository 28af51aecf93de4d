"""Runs the commands that ROS 2's tutorials print: `python benchmarks/tutorial_commands.py DOCUMENTATION [--only PAGE]`.

DOCUMENTATION is a clone of ros2/ros2_documentation, whose branch jazzy is read. Every `ros2` and `python3` command that
the pages below print is run with the course's `ros2`, in the order of its page, in the workspace that
`tutorial_workspace.py` makes. Written is `tutorial_commands.md`, a row for each: the same as on the page, a difference
that the course announces, out of scope (compiled programs, those with a window), or missing.
"""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from programs import ROS2, Program
from tutorial_workspace import BEGINNER, BRANCH, LAUNCH, make, page_text

from course_kit import environment

LIMIT_S, SETTLES_S = 20.0, 2.0
TABLE = Path(__file__).with_suffix(".md")
CLI = "Tutorials/Beginner-CLI-Tools/"
MY_NODE = "demo_nodes_cpp parameter_blackboard --ros-args -r __node:=my_node -p my_string:=text -p my_int_array:=[1]"
PAGES = {  # page: what its reader has started before
    "Concepts/Basic/About-Command-Line-Tools": ["demo_nodes_cpp talker"],
    "Concepts/Basic/About-Parameters": [],
    "How-To-Guides/Launch-file-different-formats": [],
    "How-To-Guides/Node-arguments": [],
    "How-To-Guides/Using-ros2-param": [MY_NODE],
    f"{CLI}Introducing-Turtlesim/Introducing-Turtlesim": [],
    f"{CLI}Launching-Multiple-Nodes/Launching-Multiple-Nodes": [],
    f"{CLI}Recording-And-Playing-Back-Data/Recording-And-Playing-Back-Data": [],
    f"{CLI}Understanding-ROS2-Actions/Understanding-ROS2-Actions": [],
    f"{CLI}Understanding-ROS2-Nodes/Understanding-ROS2-Nodes": [],
    f"{CLI}Understanding-ROS2-Parameters/Understanding-ROS2-Parameters": [],
    f"{CLI}Understanding-ROS2-Services/Understanding-ROS2-Services": [],
    f"{CLI}Understanding-ROS2-Topics/Understanding-ROS2-Topics": [],
    f"{CLI}Using-Rqt-Console/Using-Rqt-Console": [],
    f"{BEGINNER}Creating-Your-First-ROS2-Package": [],
    f"{BEGINNER}Custom-ROS2-Interfaces": [],
    f"{BEGINNER}Getting-Started-With-Ros2doctor": [],
    f"{BEGINNER}Using-Parameters-In-A-Class-Python": [],
    f"{BEGINNER}Writing-A-Simple-Py-Publisher-And-Subscriber": [],
    f"{BEGINNER}Writing-A-Simple-Py-Service-And-Client": [],
    f"{LAUNCH}Creating-Launch-Files": [],
    f"{LAUNCH}Launch-system": [],
    f"{LAUNCH}Using-Event-Handlers": [],
    f"{LAUNCH}Using-ROS2-Launch-For-Large-Projects": [],
    f"{LAUNCH}Using-Substitutions": [],
    "Tutorials/Demos/Service-Introspection": [],
    "Tutorials/Intermediate/Creating-an-Action": [],
    "Tutorials/Intermediate/Monitoring-For-Parameter-Changes-Python": [],
    "Tutorials/Intermediate/Writing-an-Action-Server-Client/Py": [],
}
# What a command says, where one of the course answers in another way on purpose
DIFFERENT = (
    r"exists in ROS 2; this course does not have it[^\n]*|[^\n]*(?:XML|YAML)[^\n]*Python[^\n]*|"
    r"[^\n]*reads launch files in Python[^\n]*|[^\n]*is not part of the course kit's launch files[^\n]*"
)
# What it says where a program in C++, or one with a window, is meant
COMPILED = r"Package '\w+' not found(?:: it comes with a full ROS 2 installation)?"


class Shown(NamedTuple):
    """What the pages show for a kind of commands: patterns of the command, and of what it prints."""

    command: str
    output: str


NAMES = r"use_sim_time"
SHOWN = (
    Shown(r"run \S+ (talker|publisher).*", r"Publishing: "),
    Shown(r"run \S+ listener", r"I heard"),
    Shown(r"run py_srvcli client 2 3 1|run py_srvcli client 2 3", r"(for 2 \+ 3 (\+ 1 )?= [56])"),
    Shown(r"run python_parameters .*", r"Hello world"),
    Shown(r"run .*", r""),
    Shown(r"launch .*--show-args", r"'turtlesim_ns'"),
    Shown(r"launch python_parameters .*", r"Hello earth"),
    Shown(r"launch .*", r"process started with pid"),
    Shown(r"--help", r"usage: ros2"),
    Shown(r"param list( \S+)?", NAMES),
    Shown(r"param get \S+ background_g", r"Integer value is: 86\n"),
    Shown(r"param get \S+ use_sim_time", r"Boolean value is: False\n"),
    Shown(r"param set \S+ my_string off", r"Setting parameter failed|Wrong parameter type"),
    Shown(r"param set .*", r"Set parameter successful\n"),
    Shown(r"param delete .*", r"Deleted parameter successfully\n|cannot be undeclared\n"),
    Shown(r"param describe .*", r"Parameter name: use_sim_time\n  Type: boolean\n"),
    Shown(r"param dump .*", r"ros__parameters:\n"),
    Shown(r"param load .*", r"Set parameter use_sim_time successful\n"),
    Shown(r"node list", r"/"),
    Shown(r"node info .*", r"  Subscribers:\n(.|\n)*  Action Clients:\n"),
    Shown(r"topic list", r"/turtle1/cmd_vel\n"),
    Shown(r"topic echo /turtle1/cmd_vel", r"linear:\n  x: "),
    Shown(r"topic echo /turtle1/pose", r"x: 5\.5\n"),
    Shown(r"topic echo /turtle1/color_sensor", r"b: 255\n"),
    Shown(r"topic echo /chatter", r"data: "),
    Shown(r"topic info .*", r"Type: geometry_msgs/msg/Twist\nPublisher count: \d\nSubscription count: \d\n"),
    Shown(r"topic pub .*", r"publish(ing|er|ed)"),
    Shown(r"topic hz .*", r"average rate: "),
    Shown(r"topic bw .*", r"B/s from "),
    Shown(r"topic find .*", r"/turtle1/cmd_vel\n"),
    Shown(r"service list -t", r"/clear \[std_srvs/srv/Empty\]\n"),
    Shown(r"service list", r"/(clear|add_two_ints)\n"),
    Shown(r"service type .*", r"std_srvs/srv/Empty\n"),
    Shown(r"service info .*", r"Type: std_srvs/srv/Empty\nClients count: 0\nServices count: 1\n"),
    Shown(r"service find .*", r"/clear\n/reset\n"),
    Shown(r"service call /clear .*", r"response:\nstd_srvs\.srv\.Empty_Response\(\)"),
    Shown(r"service call /spawn .*", r"response:\nturtlesim\.srv\.Spawn_Response\(name='turtle2'\)"),
    Shown(r"service echo .*", r"event_type: REQUEST_|is service introspection on the client"),
    Shown(r"action list -t", r"/turtle1/rotate_absolute \[turtlesim/action/RotateAbsolute\]\n"),
    Shown(r"action list", r"/turtle1/rotate_absolute\n"),
    Shown(r"action type .*", r"turtlesim/action/RotateAbsolute\n"),
    Shown(r"action info .*", r"Action clients: 1\n +/teleop_turtle\nAction servers: 1\n +/turtlesim\n"),
    Shown(r"action send_goal .*--feedback.*", r"Feedback:\n(.|\n)*finished with status: SUCCEEDED"),
    Shown(r"action send_goal .*", r"Goal accepted with ID: \w+\n(.|\n)*finished with status: SUCCEEDED"),
    Shown(r"interface show std_srvs/srv/Empty", r"^---\n$"),
    Shown(r"interface show .*", r"(int64 num|float64 x|int64 c|float32 \w+|int32 order|float64 z)"),
    Shown(r"pkg executables .*", r"turtlesim turtlesim_node\n"),
    Shown(r"doctor.*", r"checks passed|NETWORK CONFIGURATION|: "),
    Shown(r"fibonacci_action_server.py", r""),
    Shown(r"fibonacci_action_client.py", r"Result: "),
)
FILES = {  # that a reader has
    "demo_params.yaml": "parameter_blackboard:\n  ros__parameters:\n    some_int: 42\n",
    "my_node.yaml": "/my_node:\n  ros__parameters:\n    use_sim_time: false\n",
}
STAYS = re.compile(r"(run|launch) |topic (pub|echo|hz|bw) |service echo |fibonacci_action_server")
STARTS = re.compile(r"(run|launch) |fibonacci_action_server")


def commands_of(documentation: Path, page: str) -> list[str]:
    """The commands that a page prints and that can be typed, each once in a row; forms with <names> are none."""
    lines = [line.rstrip() for line in page_text(documentation, page).splitlines()]
    found: list[str] = []
    for number, line in enumerate(lines):
        match = re.fullmatch(r"\s+[$>]?\s*((?:ros2|python3) .*)", line)
        if match:
            command, following = match[1], number
            while command.endswith("\\"):
                following += 1
                command = command[:-1].rstrip() + " " + lines[following].strip()
            if not re.search(r"<[\w|. -]+>|\.\.\.$|package_name executable|my_package node_ex", command):
                found += [command] if command not in found else []
    return found


class Page:
    """The terminals of somebody who follows a page."""

    def __init__(self, workspace: Path, domain: int) -> None:
        self._workspace = workspace
        self._environ = environment.child_environment(
            ROS_DOMAIN_ID=str(domain),
            PYTHONUNBUFFERED="1",
            USER="learner",
            COURSE_KIT_INTERFACE_PATH=str(workspace / "interfaces"),
        )
        self._open: dict[str, Program] = {}

    def start(self, command: str, wanted: str) -> tuple[bool, str]:
        """Type a command in a terminal of its own; whether it shows what is wanted, and all that it shows."""
        words, _, into = command.partition(" > ")
        tool, *rest = shlex.split(words)
        key = " ".join(rest[:3])
        if key in self._open:
            self._open.pop(key).stop()
        program = Program([*(ROS2 if tool == "ros2" else [sys.executable]), *rest], self._workspace, self._environ)
        stays = STAYS.match(" ".join(rest))
        shown = program.prints(wanted or r"\Z.", 1.0 if stays and not wanted else LIMIT_S, until_end=not stays)
        if stays and not wanted:
            shown = program.is_running()
        if STARTS.match(" ".join(rest)) and program.is_running():
            time.sleep(SETTLES_S)  # as long as a reader takes to open the next terminal
            shown = shown and program.is_running() and not re.search(r"Traceback|has died", program.output)
        if into:
            (self._workspace / into).write_text(program.output)
        if stays and program.is_running():
            self._open[key] = program
        else:
            program.stop()
        return shown, program.output

    def close(self) -> None:
        """End what still runs."""
        for program in self._open.values():
            program.stop()
        subprocess.run([*ROS2, "daemon", "stop"], env=self._environ, check=False, capture_output=True)


def outcome(page: Page, command: str) -> str:
    """A row's last cell."""
    _, _, rest = command.partition(" ")
    shown = next((one for one in SHOWN if re.fullmatch(one.command, rest.split(" > ")[0])), None)
    if shown is None:
        works, output = page.start(command, r"\Z.")
    else:
        works, output = page.start(command, shown.output)
    if works:
        return "same"
    if different := re.search(DIFFERENT, output):
        return f"announced difference: {different[0].removeprefix('Launch failed:').strip()}"
    if compiled := re.search(COMPILED, output):
        return f"out of scope: {compiled[0].strip()}"
    return f"missing: {output.strip()[-300:]}" + ("" if shown else " (not judged)")


def main() -> None:
    documentation, only = Path(sys.argv[1]).resolve(), sys.argv[3] if sys.argv[2:3] == ["--only"] else ""
    rows: list[tuple[str, str, str]] = []
    for name, before in PAGES.items():
        if only not in name:
            continue
        with environment.exclusive_domain() as domain, tempfile.TemporaryDirectory() as folder:
            make(Path(folder), documentation)
            for file, text in FILES.items():
                (Path(folder) / file).write_text(text)
            page = Page(Path(folder), domain)
            for command in before:
                page.start(f"ros2 run {command}", "")
            for command in commands_of(documentation, name):
                rows.append((name, command, outcome(page, command).replace(folder, "...")))
                print(*rows[-1], sep=" | ", flush=True)
            page.close()
    text = table(rows)
    print(text)
    if not only:
        TABLE.write_text(text)


def table(rows: list[tuple[str, str, str]]) -> str:
    """The table, with what it comes to."""
    counts = Counter(found.partition(":")[0] for _, _, found in rows)
    total = ", ".join(f"{number} {word}" for word, number in counts.most_common())
    lines = [
        "# The commands of ROS 2's tutorials",
        "",
        f"Written by `python benchmarks/tutorial_commands.py` from the pages of {BRANCH}:",
        f"{len(rows)} commands, {total}.",
        "",
        "Python programs, launch files and interfaces are those that the pages print; `turtlesim`, `demo_nodes_cpp`",
        "and `turtle_tf2_py` are stood in for by programs of the same names, topics, services and types. Left out are",
        "forms such as `ros2 run <package_name> <executable_name>`, and a command's second time on its page.",
        "",
        "| page | command | outcome |",
        "|---|---|---|",
    ]
    cells = [[cell.replace("|", "\\|").replace("\n", " ") for cell in row] for row in rows]
    return "\n".join([*lines, *(f"| {page} | `{command}` | {found} |" for page, command, found in cells)]) + "\n"


if __name__ == "__main__":
    main()

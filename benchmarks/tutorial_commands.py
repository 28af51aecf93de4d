"""Runs the commands that ROS 2's tutorials print: `python benchmarks/tutorial_commands.py DOCUMENTATION`.

DOCUMENTATION is a clone of ros2/ros2_documentation, whose branch jazzy is read. Every `ros2` and `python3` command that
the pages of `tutorials.toml` print is run with the course's `ros2`, in the order of its page. Its workspace holds the
Python programs, launch files and interfaces that the pages print, unmodified; what the pages start in compiled packages
(turtlesim, demo_nodes_cpp) is stood in for by programs of the same names, topics, services and types.
Written is `tutorial_commands.md`, a row for each: the same as on the page, a difference that the course announces, out
of scope (compiled programs, those with a window), or missing.
"""

from __future__ import annotations

import itertools
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING

import tomllib

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator

BRANCH = "jazzy"
TABLE = Path(__file__).with_suffix(".md")
TUTORIALS = tomllib.loads(Path(__file__).with_name("tutorials.toml").read_text(encoding="utf-8"))
ROS2 = [sys.executable, "-m", "course_kit.ros2cli"]
LIMIT_S, SETTLES_S, GRACE_S = 20.0, 2.0, 5.0
# What a command says, where one of the course answers in another way on purpose
DIFFERENT = (
    r"exists in ROS 2; this course does not have it[^\n]*|[^\n]*(?:XML|YAML)[^\n]*Python[^\n]*|"
    r"[^\n]*reads launch files in Python[^\n]*|[^\n]*is not part of the course kit's launch files[^\n]*"
)
# What it says where a program in C++, or one with a window, is meant
COMPILED = r"Package '\w+' not found(?:: it comes with a full ROS 2 installation)?"
STAYS = re.compile(r"(run|launch) |topic (pub|echo|hz|bw) |service echo |fibonacci_action_server")
STARTS = re.compile(r"(run|launch) |fibonacci_action_server")
NODE = """
import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState as State
{imports}

class StandIn(Node):
    def __init__(self):
        super().__init__({name!r}{options})
{body}

def main():
    rclpy.init()
    rclpy.spin(StandIn())
"""


class Program:
    """A running program, and what it has printed."""

    def __init__(self, command: list[str], folder: Path, environ: dict[str, str]) -> None:
        self.output = ""
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            env=environ,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        for line in self._process.stdout or ():
            self.output += line

    def prints(self, wanted: str, seconds: float, *, until_end: bool = False) -> bool:
        """Whether it prints something, and with `until_end` has ended, before time is up."""
        ends = time.monotonic() + seconds
        while time.monotonic() < ends and self.is_running():
            if not until_end and re.search(wanted, self.output):
                return True
            time.sleep(0.05)
        self._reader.join(0 if self.is_running() else GRACE_S)
        return bool(re.search(wanted, self.output)) and not (until_end and self.is_running())

    def is_running(self) -> bool:
        """Whether it has not ended."""
        return self._process.poll() is None

    def stop(self) -> None:
        """Ctrl-C, and an end by force for what goes on."""
        for sign in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if not self.is_running():
                break
            os.killpg(self._process.pid, sign)
            try:
                self._process.wait(GRACE_S)
            except subprocess.TimeoutExpired:
                continue
        self._reader.join(GRACE_S)


def make(folder: Path, documentation: Path) -> None:
    """Write the workspace."""
    source = folder / "src"
    make_stand_ins(source)
    for name, text in TUTORIALS["interfaces"].items():
        path = folder / "interfaces" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name, (page, needle) in TUTORIALS["printed"].items():
        path = (source if "/" in name else folder) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(printed(documentation, page, needle))
    for name, text in TUTORIALS["files"].items():  # that a reader has
        (folder / name).write_text(text)


def make_stand_ins(source: Path) -> None:
    """Write the packages, with the programs that stand in for compiled ones."""
    for package, programs in TUTORIALS["programs"].items():
        place = source / package
        (place / package).mkdir(parents=True)
        (place / package / "__init__.py").touch()
        (place / "package.xml").write_text(f"<package><name>{package}</name></package>")
        points = [f"{name} = {package}.{module}:main" for name, module in programs.items()]
        (place / "setup.py").write_text(f"setup(name={package!r}, entry_points={{'console_scripts': {points!r}}})")
    for name, text in TUTORIALS["launch_files"].items():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        (source / name).write_text(text)
    for module, one in TUTORIALS["stand_ins"].items():
        inner = textwrap.indent(one.get("body", "pass\n"), " " * 8) + textwrap.indent(one.get("methods", ""), " " * 4)
        package, _, file = module.partition(".")
        text = NODE.format(imports=one.get("imports", ""), name=one["name"], options=one.get("options", ""), body=inner)
        (source / package / package / f"{file}.py").write_text(text)


def page_text(documentation: Path, page: str) -> str:
    """A page's source, or the text of a file that one includes."""
    path = f"source/{page}" if page.endswith(".py") else f"source/{page}.rst"
    command = ["git", "-C", str(documentation), "show", f"{BRANCH}:{path}"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def printed(documentation: Path, page: str, needle: str) -> str:
    """The longest block of code on a page that holds a text."""
    text = page_text(documentation, page)
    if page.endswith(".py"):
        return text
    return max((code for code in blocks(text) if needle in code), key=len)


def blocks(text: str) -> Iterator[str]:
    """The blocks of code of a page: the lines below each directive that are further in than it is."""
    lines = text.expandtabs(8).splitlines()
    for number, line in enumerate(lines):
        if directive := re.match(r"( *)\.\. code-block::", line):
            inside = re.compile(rf" {{{len(directive[1]) + 1},}}|\s*$")
            code = list(itertools.takewhile(inside.match, lines[number + 1 :]))
            options = len(list(itertools.takewhile(str.strip, code)))  # such as :linenos:
            yield textwrap.dedent("\n".join(code[options:])).strip("\n") + "\n"


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
    words = command.partition(" ")[2].split(" > ")[0]
    shown = next((output for known, output in TUTORIALS["shown"].items() if re.fullmatch(known, words)), None)
    works, output = page.start(command, r"\Z." if shown is None else shown)
    if works:
        return "same"
    if different := re.search(DIFFERENT, output):
        return f"announced difference: {different[0].removeprefix('Launch failed:').strip()}"
    if compiled := re.search(COMPILED, output):
        return f"out of scope: {compiled[0].strip()}"
    return f"missing: {output.strip()[-300:]}" + (" (not judged)" if shown is None else "")


def main() -> None:
    documentation = Path(sys.argv[1]).resolve()
    rows: list[tuple[str, str, str]] = []
    for name, before in TUTORIALS["pages"].items():
        with environment.exclusive_domain() as domain, tempfile.TemporaryDirectory() as folder:
            make(Path(folder), documentation)
            page = Page(Path(folder), domain)
            for command in before:
                page.start(f"ros2 run {command}", "")
            for command in commands_of(documentation, name):
                rows.append((name, command, outcome(page, command).replace(folder, "...")))
                print(*rows[-1], sep=" | ", flush=True)
            page.close()
    text = table(rows)
    print(text)
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

"""`course-kit tutor`: the course for an assistant, by the Model Context Protocol over standard input and output.

Each tool runs a command of the course, so an assistant sees what a learner sees and can do no more: it grades, gives
one hint of the ladder at a time, and asks nodes. No tool shows a solution or writes into a submission.
"""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit import environment
from course_kit.grading.model.catalogue import catalogue
from course_kit.learner.workspace import GUIDANCE
from course_kit.text.console import refuse

if TYPE_CHECKING:
    from mcp.server.mcpserver import MCPServer

_DEADLINE_S = 300.0
_ANSWER = re.compile(r"<details>(?:(?!<details>).)*?</details>", re.DOTALL)
_LISTINGS = (("node",), ("topic", "-t"), ("service", "-t"), ("action", "-t"))
_reports: dict[str, str] = {}


def main() -> int:
    """Serve until the assistant hangs up; 2 when the package that speaks the protocol is not installed."""
    if find_spec("mcp") is None:
        return refuse(
            "the tutor needs the package mcp, which is not installed. Run "
            '.venv/bin/python -m pip install "mcp>=2.3,<3" in the course\'s folder, then this again.'
        )
    _make_server().run("stdio")
    return 0


def _make_server() -> MCPServer:
    from mcp.server.mcpserver import MCPServer

    server = MCPServer("ros2-course", instructions=GUIDANCE.read_text(encoding="utf-8"), log_level="ERROR")
    for tool in (list_exercises, grade, next_hint, explain_diagnosis, show_graph, call_service):
        server.tool()(tool)
    root = environment.course_files()
    for path in sorted((root / "notebooks").glob("*.ipynb")) if root else ():
        _add_lesson(server, path)
    server.resource("course://report/{exercise}", description="The learner's last report, as this tutor graded it.")(
        _last_report
    )
    return server


def list_exercises() -> str:
    """List the exercises with the learner's best score, tries and hints, as JSON."""
    return _run("course-kit", "list", "--format", "json")


def grade(exercise: str) -> str:
    """Grade the learner's own file of an exercise and return the report as JSON. It counts as one try.

    Args:
        exercise: its id, as list_exercises shows it.
    """
    _reports[exercise] = _run("course-kit", "grade", exercise, "--format", "json")
    return _reports[exercise]


def next_hint(exercise: str) -> str:
    """Give one more hint of the exercise's ladder, for what failed last. Ask the learner for their own idea first.

    Args:
        exercise: its id, as list_exercises shows it.
    """
    return _run("course-kit", "hint", exercise)


def explain_diagnosis(code: str) -> str:
    """Say what a diagnosis of a report means, why it happens, and which lesson's section teaches it.

    Args:
        code: as a report has it, e.g. service.no_return.
    """
    found = catalogue().get(code)
    if found is None:
        return f"There is no diagnosis '{code}'. A report names its diagnoses as 'diagnosis'."
    return "\n".join(filter(None, (found.title, found.explanation, f"Read: {found.link}" if found.notebook else "")))


def show_graph() -> str:
    """List the nodes, topics, services and actions that run on the learner's ROS graph now."""
    listed = {name: _run("ros2", name, "list", *options) for name, *options in _LISTINGS}
    return "\n".join(f"{name}s:\n{found or '(none)'}" for name, found in listed.items())


def call_service(service: str, service_type: str, request: str = "{}") -> str:
    """Call a service on the learner's ROS graph and return what it answered.

    Args:
        service: its name, e.g. /add_two_ints.
        service_type: e.g. example_interfaces/srv/AddTwoInts.
        request: its fields as YAML, e.g. {a: 1, b: 2}.
    """
    return _run("ros2", "service", "call", service, service_type, request)


def _last_report(exercise: str) -> str:
    return _reports.get(exercise, f"{exercise} was not graded yet in this session. The tool grade does it.")


def _add_lesson(server: MCPServer, path: Path) -> None:
    server.resource(f"course://lessons/{path.stem}", name=path.stem, mime_type="text/markdown")(lambda: _read(path))


def _read(path: Path) -> str:
    """A lesson's text and programs, without outputs and folded answers, which would tell what comes."""
    cells = nbformat.read(path, as_version=4).cells
    texts = [
        _ANSWER.sub("(an answer, folded away in the lesson)", cell.source)
        if cell.cell_type == "markdown"
        else f"```python\n{cell.source}\n```"
        for cell in cells
    ]
    return "\n\n".join(texts)


def _run(command: str, *words: str) -> str:
    """What a command of this installation prints; what it says beside that, if it prints nothing."""
    try:
        done = subprocess.run(
            [Path(sys.executable).with_name(command), *words],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=_DEADLINE_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"{' '.join(words)} did not end within {_DEADLINE_S:.0f} s."
    beside = done.stderr if command == "ros2" else ""  # which says there why no answer came
    return (done.stdout + beside).strip() or done.stderr.strip()

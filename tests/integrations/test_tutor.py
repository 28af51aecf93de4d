"""`course-kit tutor`, asked by the Model Context Protocol's own client over standard input and output."""

from __future__ import annotations

import asyncio
import json
import os
import sys
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment
from course_kit.integrations import tutor
from course_kit.learner import workspace

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from mcp import Client

WRONG = """
import rclpy
from course_interfaces.srv import ConvertTemperature
from rclpy.node import Node

class Converter(Node):
    def __init__(self):
        super().__init__("temperature_service")
        self.create_service(ConvertTemperature, "convert_temperature", self.convert)

    def convert(self, request, response):
        response.success = True

rclpy.init()
rclpy.spin(Converter())
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A learner's folder with a wrong answer to exercise 1."""
    root = environment.course_files()
    assert root is not None
    workspace.make_copy(root, tmp_path / "mine")
    (tmp_path / "mine/exercises/temperature_service/temperature_service.py").write_text(WRONG)
    return tmp_path / "mine"


def ask(folder: Path, talk: Callable[[Client], Awaitable[None]]) -> None:
    from mcp import Client, StdioServerParameters  # so large that each worker would feel it
    from mcp.client.stdio import stdio_client

    async def converse() -> None:
        environ = {**os.environ, "COURSE_KIT_PROGRESS": str(folder / "progress.json"), "PYTHONPATH": ""}
        arguments = ["-c", "from course_kit.__main__ import main; main()", "tutor"]
        server = StdioServerParameters(command=sys.executable, args=arguments, env=environ, cwd=folder)
        async with Client(stdio_client(server)) as client:
            await talk(client)

    asyncio.run(converse())


def said(result: Any) -> str:
    return "\n".join(part.text for part in (getattr(result, "content", None) or result.contents))


def test_it_lists_grades_hints_explains_and_asks_nodes_and_gives_no_solution(folder: Path) -> None:
    before = {path: path.read_bytes() for path in folder.rglob("*.py")}
    heard: list[str] = []

    async def talk(client: Client) -> None:
        tools = (await client.list_tools()).tools
        assert {tool.name for tool in tools} == {
            "list_exercises", "grade", "next_hint", "explain_diagnosis", "show_graph", "call_service",
        }  # fmt: skip
        assert all(tool.description for tool in tools)
        exercises = json.loads(said(await client.call_tool("list_exercises", {})))["exercises"]
        assert exercises[0]["id"] == "temperature_service"

        unread = said(await client.read_resource("course://report/temperature_service"))
        assert "not graded yet" in unread
        report = json.loads(said(await client.call_tool("grade", {"exercise": "temperature_service"})))
        assert report["score"] < report["max_score"]
        code = next(one["diagnosis"] for one in report["checks"] if one.get("diagnosis"))
        assert code == "service.no_return"
        assert json.loads(said(await client.read_resource("course://report/temperature_service"))) == report

        explained = said(await client.call_tool("explain_diagnosis", {"code": code}))
        assert "01_services.ipynb#" in explained
        assert "no diagnosis" in said(await client.call_tool("explain_diagnosis", {"code": "no.such"}))
        hints = [said(await client.call_tool("next_hint", {"exercise": "temperature_service"})) for _ in range(2)]
        assert hints[0] != hints[1]

        lesson = said(await client.read_resource("course://lessons/01_services"))
        assert "class MinimalService" in lesson
        assert "One way to do it" not in lesson
        heard.extend([*hints, explained, json.dumps(report), lesson])

    ask(folder, talk)
    solution = (environment.PACKAGE.parent / "solutions/temperature_service/temperature_service.py").read_text()
    lines = [line.strip() for line in solution.splitlines() if line.startswith("        ") and len(line.strip()) > 30]
    assert len(lines) > 3
    assert [line for line in lines if any(line in one for one in heard)] == []
    assert {path: path.read_bytes() for path in folder.rglob("*.py")} == before


@pytest.mark.usefixtures("own_lab")
def test_it_shows_the_graph_and_calls_a_service(folder: Path) -> None:
    from rclpy.node import Node
    from std_srvs.srv import Trigger

    from course_kit import lab

    class Asked(Node):
        def __init__(self) -> None:
            super().__init__("asked")
            self.create_service(Trigger, "ask_me", self.answer)

        def answer(self, _: Any, response: Any) -> Any:
            response.message = "here I am"
            return response

    lab.start(Asked)

    async def talk(client: Client) -> None:
        graph = said(await client.call_tool("show_graph", {}))
        assert "/asked" in graph
        assert "/ask_me [std_srvs/srv/Trigger]" in graph
        words = {"service": "/ask_me", "service_type": "std_srvs/srv/Trigger"}
        assert "here I am" in said(await client.call_tool("call_service", words))
        assert "No service /nobody" in said(await client.call_tool("call_service", {**words, "service": "/nobody"}))

    ask(folder, talk)


def test_without_the_package_it_says_how_to_get_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(tutor, "find_spec", lambda _: None)
    assert tutor.main() == 2
    assert "pip install" in capsys.readouterr().err

"""The page of honest limits: what it admits is so, what it promises is tested where it says, and it is found."""

from __future__ import annotations

import re
import socket
from importlib.resources import files
from typing import TYPE_CHECKING

from course_kit import grading
from course_kit.grading.workers.worker import _PASSED_ON, _PASSED_ON_PREFIXES
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import pytest

PAGE = files("course_kit.grading").joinpath("LIMITS.md").read_text(encoding="utf-8")
CURIOUS = """
import os, socket
print("READ", os.path.exists({other!r}))
print("PUBLIC", len(os.listdir("/usr")) > 0)
with socket.socket(socket.AF_UNIX) as line:
    print("CONNECTED", line.connect_ex({path!r}))
with socket.socket(socket.AF_UNIX) as line:
    print("ABSTRACT", line.connect_ex("\\0" + {name!r}) == 0)
print("CAPABILITIES", [row.split()[1] for row in open("/proc/self/status") if row.startswith("CapEff")])
print("VARIABLES", *sorted(os.environ))
print("SEEN", len([name for name in os.listdir("/proc") if name.isdigit()]))
"""


def test_what_the_page_admits_and_promises_is_so(
    grade_source: Callable[..., grading.Report], worker: grading.Worker, tmp_path: Path
) -> None:
    other, path = tmp_path / "of_another_student.py", tmp_path / "socket"
    other.write_text("their work")
    found = worker.ready()
    name = f"course-kit-{tmp_path.name}"
    with socket.socket(socket.AF_UNIX) as by_file, socket.socket(socket.AF_UNIX) as by_name:
        by_file.bind(str(path))
        by_name.bind(f"\0{name}")
        for server in (by_file, by_name):
            server.listen()
        report = grade_source(CURIOUS.format(other=str(other), path=str(path), name=name))
    told = dict(line.split(" ", 1) for line in report.stdout.splitlines())
    assert told["READ"] == str(not found.files)
    assert told["PUBLIC"] == "True"
    assert (told["CONNECTED"] == "0") == (not found.files)
    assert told["ABSTRACT"] == str(not found.network)
    assert told["CAPABILITIES"] == "['0000000000000000']"
    assert (int(told["SEEN"]) == 2) == found.processes
    added = {"PWD", "ROS_LOG_DIR", "OPENBLAS_NUM_THREADS"}
    for variable in told["VARIABLES"].split():
        assert variable in {*_PASSED_ON, *added} or variable.startswith(_PASSED_ON_PREFIXES), variable


def test_a_command_sees_the_variables_and_the_folder_and_cannot_change_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, worker: grading.Worker
) -> None:
    monkeypatch.setenv("MY_SECRET_TOKEN", "abc123")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.txt").write_text("mine")
    command = 'sh -c "echo $MY_SECRET_TOKEN; cat mine.txt; echo theirs > mine.txt"'
    report = grading.grade("temperature_service", exec_command=command)
    assert report.stdout == "abc123\nmine"
    found = worker.ready()
    assert ((tmp_path / "mine.txt").read_text() == "mine") == (found.files or found.landlock)
    assert "The command saw your environment variables" in report.isolation


def test_the_page_names_what_there_is() -> None:
    for path in re.findall(r"`(tests/[\w/.]+)`", PAGE):
        assert (ROOT / path).is_file(), path
    for name in ("VIRTUAL_ENV", "LD_LIBRARY_PATH", "PATH"):
        assert name in PAGE
        assert name in _PASSED_ON
    for prefix in re.findall(r"`([A-Z]+_?)`", PAGE.partition("Few environment variables")[2].partition("##")[0]):
        assert prefix in _PASSED_ON_PREFIXES

"""Isolation: found by trying, told truthfully, and still a fair grade where there are none."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from course_kit import grading
from course_kit.grading.sandbox import isolation
from tests.grading.conftest import EXERCISE, ROOT
from tests.grading.sandbox import attack_modes
from tests.refused import COMMAND_WITHOUT_NAMESPACES, WITHOUT_NAMESPACES

GRADE = """
from course_kit import grading
report = grading.grade("temperature_service", sys.argv[1], seed=3)
print(report.isolation, file=sys.stderr)
print(report.to_json())
"""
GRADE_BY_A_WORKER_OF_A_CLASS = """
from course_kit.grading.engine import GradingRequest
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.reading import Reader, copy_file
from course_kit.grading.pool import Pool
asked = load_exercise("temperature_service")
with copy_file(Path(sys.argv[1])) as copy, Reader() as reader, Pool(1) as pool:
    report = pool.grade(
        GradingRequest(asked, reader.read(copy, asked), "jane.py", 7, require_isolation=sys.argv[2] == "require")
    )
print(report.status, report.problem)
"""
DAEMON = """
import os, signal, sys, time
if os.fork() == 0:
    os.setsid()
    if os.fork() == 0:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        os.execv(sys.executable, [sys.executable, "-S", "-c", "import time; time.sleep(600)", {mark!r}])
    os._exit(0)
time.sleep(0.5)
"""


def python(code: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=200, check=False
    )


def grade_without_namespaces(path: Path) -> tuple[dict[str, Any], str]:
    done = python(WITHOUT_NAMESPACES + GRADE, str(path))
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout), done.stderr


def running(mark: str) -> list[str]:
    return [path.parent.name for path in Path("/proc").glob("[0-9]*/cmdline") if mark in _command(path)]


def _command(path: Path) -> str:
    try:
        return path.read_text(errors="replace")
    except OSError:  # it has just ended
        return ""


def test_status_says_why_something_is_missing() -> None:
    found = grading.isolation_status()
    assert (found.network and found.processes and found.files) or found.reason


def test_without_namespaces_a_worker_says_why() -> None:
    program = "from course_kit import grading\nfound = grading.isolation_status()\n"
    told = "print(found.network or found.processes or found.files, found.reason)"
    assert re.match("False .*user namespaces", python(WITHOUT_NAMESPACES + program + told).stdout)


def test_ordinary_users_get_the_same_isolation() -> None:
    solution = (ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py").read_text()
    outcome = attack_modes.outcomes(attack_modes.USER, {"solution": solution})
    results = outcome["solution"]["results"]
    assert [result["status"] for result in results] == ["passed"] * len(results)
    assert len(results) > 5
    found = outcome["isolation"]
    restricted = Path("/proc/sys/kernel/apparmor_restrict_unprivileged_userns")
    if restricted.exists() and restricted.read_text().strip() == "1":
        assert found.reason
    else:
        assert replace(grading.isolation_status(), user=False, root=False) == found


def test_description_names_what_does_not_hold() -> None:
    text = isolation.Isolation(network=True, reason="no PID namespace").describe()
    assert "own network" in text.partition("Missing")[0]
    assert "own file system" not in text.partition("Missing")[0]
    assert "own file system" in text.partition("Missing")[2]
    assert "no PID namespace" in text


def test_full_isolation_can_be_required() -> None:
    everything = isolation.Isolation(network=True, processes=True, files=True, syscalls=True)
    everything.require()
    for missing in ("network", "processes", "files", "syscalls"):
        with pytest.raises(grading.GradingError, match="--require-isolation"):
            replace(everything, **{missing: False}).require()
    with pytest.raises(grading.GradingError, match="own user"):
        replace(everything, root=True).require()


def test_a_command_that_requires_isolation_refuses_to_grade_without_namespaces(tmp_path: Path) -> None:
    solution = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"
    one = python(COMMAND_WITHOUT_NAMESPACES, "grade", EXERCISE, str(solution), "--require-isolation")
    many = python(
        COMMAND_WITHOUT_NAMESPACES,
        "class",
        str(solution.parent),
        "--exercise",
        EXERCISE,
        "--out",
        str(tmp_path / "o"),
        "--require-isolation",
    )
    for done in (one, many):
        assert done.returncode == 2
        assert "Nothing was graded: --require-isolation asks for full isolation" in done.stderr
        assert done.stdout == ""


def test_each_worker_of_a_class_insists_on_isolation() -> None:
    """Also one of a cluster, on a machine that nobody has asked before, and one that replaces another."""
    solution = str(ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py")
    for wish, status in (("require", "error"), ("no", "graded")):
        done = python(WITHOUT_NAMESPACES + GRADE_BY_A_WORKER_OF_A_CLASS, solution, wish)
        assert done.returncode == 0, done.stderr
        assert done.stdout.split()[0] == status
        assert ("--require-isolation asks for full isolation" in done.stdout) == (wish == "require")


def test_solution_is_graded_without_namespaces() -> None:
    report, told = grade_without_namespaces(ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py")
    assert report["score"] == 10.0
    assert report["stderr"] == ""  # the middleware may set its threads' scheduling, and says nothing
    assert "Missing: own network, own processes, own file system" in told


def test_daemons_die_without_namespaces(tmp_path: Path) -> None:
    mark = f"course-kit-daemon-{tmp_path.name}-{os.getpid()}"
    path = tmp_path / "daemon.py"
    path.write_text(DAEMON.format(mark=mark))
    report, _ = grade_without_namespaces(path)
    assert report["score"] == 0.0
    assert running(mark) == []


def test_scratch_folder_is_removed(tmp_path: Path) -> None:
    path = tmp_path / "litter.py"
    path.write_text("import os\nprint('CWD', os.getcwd(), os.environ['HOME'])\nopen('litter', 'w').write('x' * 1000)\n")
    report, _ = grade_without_namespaces(path)
    _, cwd, home = report["stdout"].split()
    assert cwd == home
    assert not Path(cwd).exists()

"""Checks that compare with what the exercise's own solution answers."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.grading.checks.declared.declaration import Declaration
from course_kit.grading.checks.declared.messages import check_asks_the_solution
from tests.grading.checks.declared.conftest import HINTS, SOLUTION, written

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from course_kit.grading.report import Report

ADDS = """
[[checks]]
id = "adds"
kind = "answers"
title = "It adds."
points = 1.0
service = "/add"
requests = {a = {draw = [100, 900], count = 3}, b = {draw = [1, 9]}}
expect = "oracle"
"""
ALL = (
    ADDS
    + """
[[checks]]
id = "field"
kind = "answers"
title = "It converts."
points = 1.0
service = "/convert"
cases = [{request = {value = 3.5, from_unit = "celsius", to_unit = "fahrenheit"}, expect = {value = "oracle.value"}}]
[[checks]]
id = "limits"
kind = "topic_answers"
title = "It limits."
points = 1.0
publisher = "/cmd_out"
messages = {linear.x = {draw = [-3.0, 3.0], count = 4}}
expect = "oracle"
[[checks]]
id = "acts"
kind = "parameter_acts"
title = "It acts."
points = 1.0
node = "all_kinds"
publisher = "/cmd_out"
set = {limit = {draw = [0.5, 4.5], count = 2}}
messages = [{linear.x = 9.0}, {linear.x = -9.0}]
expect = "oracle"
[[checks]]
id = "acts_alone"
kind = "parameter_acts"
title = "It acts alone."
points = 1.0
node = "all_kinds"
publisher = "/beat"
set = {limit = {draw = [0.5, 4.5]}}
expect = {data = "oracle.data"}
[[checks]]
id = "succeeds"
kind = "goal_succeeds"
title = "It succeeds."
points = 1.0
action = "/fib"
goals = [{order = 3}, {order = {draw = [5, 12]}}]
expect = "oracle"
"""
)
PRINTED = "what-the-solution-says-to-itself"
SECRET = "the-solutions-own-word"  # noqa: S105 - a text to look for
# Adds something that nobody can guess, and says what nobody is to hear.
SECRETIVE = SOLUTION.replace("r.sum = q.a + q.b", f"r.sum = q.a + q.b + {len(SECRET)}").replace(
    "import time\n",
    f"import sys\nimport time\nKEPT = '{SECRET}'\nprint('{PRINTED}')\nprint('{PRINTED}', file=sys.stderr)\n",
)


def test_the_solution_is_right_by_its_own_answers(grade: Callable[..., Report]) -> None:
    report = grade(ALL)
    assert [(one.id, one.status, one.told) for one in report.checks if one.status != "passed"] == []
    assert report.score == 6.0


@pytest.mark.parametrize(
    ("change", "check"),
    [
        (("r.sum = q.a + q.b", "r.sum = q.a - q.b"), "adds"),
        (("* 9 / 5 + 32", "* 9 / 5"), "field"),
        (("max(-v, min(v, m.linear.x))", "min(v, m.linear.x)"), "limits"),
        (('v = self.get_parameter("limit").value', "v = 1.0"), "acts"),
        (("range(1, h.request.order)", "range(1, h.request.order - 1)"), "succeeds"),
    ],
)
def test_a_wrong_program_is_told_what_the_solution_answers(
    grade: Callable[..., Report], change: tuple[str, str], check: str
) -> None:
    report = grade(ALL, change)
    found = {one.id: one for one in report.checks}[check]
    assert (found.status, bool(found.expected), bool(found.got)) == ("failed", True, True), report.problem


def test_nothing_of_the_solution_is_in_the_report(worker: grading.Worker, tmp_path: Path) -> None:
    path = written(tmp_path, ADDS)
    (path.parent / "solution" / "all_kinds.py").write_text(SECRETIVE)
    program = tmp_path / "answer.py"
    program.write_text(SOLUTION)
    report = grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent)
    assert [one.status for one in report.checks] == ["failed"]  # it adds 22 less
    assert "22" not in report.checks[0].told
    assert PRINTED not in str(report)
    assert SECRET not in str(report)
    assert report.timings["start_s"] > 0.0


# Looks for the solution, and for a server that is no longer there, in every way that a program has.
SPY = (
    SOLUTION
    + """

import os, pathlib, re
found = []
wanted = re.compile(rb"the-solu[t]ions-own-w[o]rd")
for name in os.listdir("/proc"):
    if name.isdigit():
        for part in ("cmdline", "environ", "mem"):
            try:
                spans = [(0, 1 << 20)]
                if part == "mem":
                    maps = [line.split() for line in open(f"/proc/{name}/maps")]
                    spans = [[int(one, 16) for one in line[0].split("-")] for line in maps if line[1].startswith("rw")]
                with open(f"/proc/{name}/{part}", "rb") as file:
                    for low, high in spans:
                        for place in range(low, high, 1 << 20):
                            file.seek(place)
                            if wanted.search(file.read(min((1 << 20) + 64, high - place))):
                                found.append(f"/proc/{name}/{part}")
            except (OSError, ValueError, OverflowError):
                pass


def files():
    for top in ("/tmp", os.getcwd(), str(pathlib.Path(os.getcwd()).parent), "/dev/shm", "/var/tmp", "/run"):
        for folder, folders, names in os.walk(top):
            folders[:] = [one for one in folders if one != "site-packages"]  # of a course that is installed in /tmp
            for name in names:
                try:
                    if wanted.search(pathlib.Path(folder, name).read_bytes()):
                        yield f"{folder}/{name}"
                except OSError:
                    pass


found += files()
mine = int(os.environ["ROS_DOMAIN_ID"])
for domain in [mine - 1]:
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    spy = rclpy.create_node("spy", context=context)
    client = spy.create_client(AddTwoInts, "/add")
    if client.wait_for_service(0.4):
        found.append(f"a server on domain {domain}")
    rclpy.shutdown(context=context)
pathlib.Path("planted").write_text("".join(["the-solu", "tions-own-word"]))  # Python joins two constants beforehand
print("SPIED" if list(files()) else "BLIND", flush=True)
print(*[f"WON {one}" for one in found], sep="\\n", flush=True)
"""
)


@pytest.mark.attack("a submission that looks for the exercise's solution, which answered before it was started")
def test_a_submission_does_not_meet_the_solution(worker: grading.Worker, tmp_path: Path) -> None:
    path = written(tmp_path, ADDS, more=f"{HINTS}[limits]\nstart_s = 60.0\nstart_cpu_s = 50.0\ncpu_s = 60\n")
    (path.parent / "solution" / "all_kinds.py").write_text(SECRETIVE)
    program = tmp_path / "answer.py"
    program.write_text(SPY)
    report = grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent)
    assert "SPIED" in report.stdout, f"{grading.render_text(report)}\n{report.stderr}"
    assert "WON" not in report.stdout
    assert report.score == 0.0


@pytest.mark.parametrize(
    ("solution", "said"),
    [
        (None, "cannot be read"),
        ("raise SystemExit(2)\n", "own solution does not answer"),
        (SOLUTION.replace("r.sum = q.a + q.b", "raise ValueError"), "own solution does not answer"),
        (SOLUTION.replace('"add", self.add', '"plus", self.add'), "own solution does not answer"),
    ],
    ids=["missing", "ends", "raises", "another name"],
)
def test_a_solution_that_does_not_answer_is_the_authors_to_mend(
    worker: grading.Worker, tmp_path: Path, solution: str | None, said: str
) -> None:
    path = written(tmp_path, ADDS)
    of_the_exercise = path.parent / "solution" / "all_kinds.py"
    of_the_exercise.unlink()
    if solution is not None:
        of_the_exercise.write_text(solution)
    program = tmp_path / "answer.py"
    program.write_text(SOLUTION)
    try:
        told = grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent).problem
    except grading.GradingError as problem:
        told = str(problem)
    assert said in told


def test_a_program_that_is_no_python_needs_no_answers(worker: grading.Worker, tmp_path: Path) -> None:
    path = written(tmp_path, ADDS)
    (path.parent / "solution" / "all_kinds.py").write_text("raise SystemExit(2)\n")
    program = tmp_path / "answer.py"
    program.write_text("def f(:\n")
    report = grading.grade("all_kinds", program, worker=worker, seed=3, exercises=path.parent.parent)
    assert [one.known.code for one in report.checks if one.known] == ["start.syntax"]


@pytest.mark.usefixtures("domain")
def test_a_node_that_runs_already_is_compared_as_well(tmp_path: Path) -> None:
    path = written(tmp_path, ADDS)
    program = tmp_path / "answer.py"
    program.write_text(SOLUTION + "\n\nrclpy.init()\nrclpy.spin(AllKinds())\n")
    with subprocess.Popen([sys.executable, program]) as running:
        try:
            report = grading.grade("all_kinds", attach=True, seed=3, exercises=path.parent.parent)
        finally:
            running.kill()
    assert [(one.status, one.told) for one in report.checks] == [("passed", "")], report.problem


@pytest.mark.parametrize(
    ("expected", "asks"),
    [
        ("oracle", True),
        ({"value": "oracle.value * 2"}, True),
        ({"point": {"x": "1 if oracle.a else 2"}}, True),
        ({"value": "request.oracle"}, False),
        ({"value": "'oracle'"}, False),
        ({"value": 1.0}, False),
    ],
)
def test_it_is_known_whether_the_solution_is_asked(expected: object, asks: bool) -> None:
    check = Declaration("a", "answers", "A", 1.0, 6.0, keys={"expect": expected})
    assert check_asks_the_solution(check) is asks

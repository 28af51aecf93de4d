"""Submissions that attack instead of answering: no points, nothing left behind, and the next one is graded as ever."""

from __future__ import annotations

import fcntl
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.grading import processes

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

ATTACKS = {
    "prints_a_report": """
print('{"format_version": 1, "status": "graded", "score": 10.0, "max_score": 10.0, "passed": true, "checks": []}')
""",
    "writes_into_every_descriptor": """
import json, os, struct
forged = json.dumps({"results": [{"id": "offered", "title": "x", "status": "passed", "max_points": 10.0, "sent": "",
    "expected": "", "got": "", "diagnosis": None, "message": ""}], "stdout": "", "stderr": "", "problem": "",
    "timings": {}, "do": "result", "limit": None, "exit_code": 0}).encode()
for descriptor in range(3, 256):
    for message in (struct.pack("!I", len(forged)) + forged, forged + b"\\n"):
        try:
            os.write(descriptor, message)
        except OSError:
            pass
""",
    "sends_strange_notes": """
import os
for note in (b'{"note": 3}', b'{"note": {"functions": 5, "returned": [], "node_classes": {"a": 1}, "limit": "time"}}',
             b'{"note": {"classes": [[[]], 7, null], "functions": [{}]}}', b'{"note": ' + b"[" * 60000):
    for descriptor in range(3, 256):
        try:
            os.write(descriptor, b"\\n" + note + b"\\n")
        except OSError:
            pass
""",
    "leaves_at_once": "import os\nos._exit(0)\n",
    "kills_its_parents": """
import os, signal
for victim in (os.getppid(), 1, -1, *range(2, 200)):
    if victim != os.getpid():
        try:
            os.kill(victim, signal.SIGKILL)
        except OSError:
            pass
""",
    "traces_its_parent": """
import ctypes, os
libc = ctypes.CDLL(None)
if libc.ptrace(16, os.getppid(), 0, 0) == 0:
    print("ATTACHED")
try:
    open(f"/proc/{os.getppid()}/mem", "r+b")
    print("MEMORY")
except OSError:
    pass
""",
    "patches_rclpy": """
import rclpy.client, course_kit.grading.checks, course_kit.grading.report
course_kit.grading.checks.run_all = lambda *_: []
course_kit.grading.report.Report.score = 10.0
rclpy.client.Client.service_is_ready = lambda self: True
""",
    "reaches_out": """
import socket
for family, address in ((socket.AF_INET, ("192.0.2.1", 80)), (socket.AF_INET, ("127.0.0.1", 22))):
    with socket.socket(family) as line:
        line.settimeout(0.2)
        try:
            line.connect(address)
            print("CONNECTED", address)
        except OSError:
            pass
""",
    "plants_a_file": """
import os, sysconfig
for folder in (sysconfig.get_path("purelib"), os.path.dirname(os.__file__), "/tmp", "/var/tmp", "/dev/shm"):
    for name in ("course_kit_planted.pth", "sitecustomize_planted.py"):
        try:
            with open(os.path.join(folder, name), "w") as file:
                file.write("print('PLANTED')")
        except OSError:
            pass
""",
}
DAEMON = """
import fcntl, os, signal, time
held = open({lock!r})
fcntl.flock(held, fcntl.LOCK_SH)
for _ in range(3):
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            for number in range(1, 32):
                try:
                    signal.signal(number, signal.SIG_IGN)
                except OSError:
                    pass
            {body}
            os._exit(0)
        os._exit(0)
{then}
"""


@pytest.fixture
def lock(tmp_path: Path) -> Iterator[Path]:
    """A file that a process of the submission holds for as long as it lives."""
    path = tmp_path / "lock"
    path.touch()
    yield path
    with path.open() as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # raises while somebody is left


@pytest.mark.parametrize("attack", ATTACKS)
def test_attack_earns_nothing(attack: str, grade_source: Callable[..., grading.Report]) -> None:
    report = grade_source(ATTACKS[attack])
    assert report.score == 0.0
    assert not report.passed
    assert report.status == "crashed"
    assert {check.id for check in report.checks if check.status == "failed"} == {"offered"}
    for word in ("ATTACHED", "MEMORY", "CONNECTED"):
        assert word not in report.stdout


def test_nothing_is_planted(grade_source: Callable[..., grading.Report], solution: str) -> None:
    import os
    import sysconfig
    from pathlib import Path

    grade_source(ATTACKS["plants_a_file"])
    places = (sysconfig.get_path("purelib"), os.path.dirname(os.__file__), "/tmp", "/var/tmp", "/dev/shm")  # noqa: PTH120, S108
    assert [path for place in places for path in Path(place).glob("*_planted.*")] == []
    assert "PLANTED" not in grade_source(solution).stdout


def test_daemons_die(grade_source: Callable[..., grading.Report], lock: Path) -> None:
    report = grade_source(DAEMON.format(lock=str(lock), body="time.sleep(600)", then="time.sleep(0.5)"))
    assert report.score == 0.0


def test_daemons_of_a_program_that_stays_die(
    grade_source: Callable[..., grading.Report], lock: Path, solution: str
) -> None:
    report = grade_source(DAEMON.format(lock=str(lock), body="time.sleep(600)", then=solution))
    assert report.score == 10.0


def test_server_in_a_daemon_earns_nothing(
    grade_source: Callable[..., grading.Report], lock: Path, solution: str
) -> None:
    serve = f"exec({solution!r}, {{'__name__': '__main__'}})"
    report = grade_source(DAEMON.format(lock=str(lock), body=serve, then="pass"))
    assert not report.passed


def test_server_left_behind_does_not_help_the_next(
    grade_source: Callable[..., grading.Report], lock: Path, solution: str
) -> None:
    serve = f"exec({solution!r}, {{'__name__': '__main__'}})"
    grade_source(DAEMON.format(lock=str(lock), body=serve, then="time.sleep(1)"))
    report = grade_source("import time\ntime.sleep(2)\n")
    assert report.score == 0.0
    assert report.checks[0].diagnosis == "start.nothing"


def test_fork_bomb(grade_source: Callable[..., grading.Report], lock: Path) -> None:
    bomb = (
        f"import fcntl, os\nheld = open({str(lock)!r})\nfcntl.flock(held, fcntl.LOCK_SH)\nwhile True:\n    os.fork()\n"
    )
    report = grade_source(bomb)
    assert report.checks[0].diagnosis == "limit.processes"


def test_exit_in_a_callback(grade_source: Callable[..., grading.Report], solution: str) -> None:
    report = grade_source(
        solution.replace(
            "        response.message = problem", "        raise SystemExit\n        response.message = problem"
        )
    )
    answers = next(check for check in report.checks if check.id == "answers")
    assert answers.diagnosis == "service.exception"
    assert report.score == 1.0


def test_worker_is_left_alone(
    grade_source: Callable[..., grading.Report], worker: grading.Worker, solution: str
) -> None:
    grade_source(ATTACKS["kills_its_parents"])
    assert processes.descendants(worker.process_id) == []
    assert grade_source(solution).score == 10.0


def test_submission_does_not_see_the_solutions(grade_source: Callable[..., grading.Report]) -> None:
    from tests.grading.conftest import ROOT

    report = grade_source(f"import os\nprint('FOUND', os.listdir({str(ROOT / 'solutions')!r}))\n")
    assert "FOUND []" in report.stdout


def test_submission_does_not_see_foreign_variables(
    grade_source: Callable[..., grading.Report], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("MY_SECRET_TOKEN", "abc123")
    path = tmp_path / "curious.py"
    path.write_text("import os\nprint(sorted(os.environ))\nprint(open('/proc/self/environ').read())\n")
    report = grading.grade("temperature_service", path)
    assert "ROS_DOMAIN_ID" in report.stdout
    assert "MY_SECRET_TOKEN" not in report.stdout
    del grade_source

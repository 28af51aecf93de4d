"""Submissions that attack instead of answering: no points, nothing left behind, and the next one is graded as ever."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import threading
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment, grading
from tests import several_files
from tests.grading.conftest import IDLE, processes_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import TypeAlias

    Grade: TypeAlias = Callable[..., grading.Report]
    Strict: TypeAlias = Callable[..., Path]

KILLS = "kills_its_parents"
OUR_PROCESSES = os.readlink("/proc/self/ns/pid")  # noqa: PTH115 - no path, but the name of this PID namespace
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
    KILLS: f"""
import os, signal
victims = [os.getppid()]
if os.readlink("/proc/self/ns/pid") != {OUR_PROCESSES!r}:  # else it would kill whatever the grader_node has running
    victims += [1, -1, *range(2, 200)]
    print("EVERYBODY", flush=True)
for victim in victims:
    if victim != os.getpid():
        try:
            os.kill(victim, signal.SIGKILL)
        except OSError:
            pass
""",
    "patches_rclpy": """
import rclpy.client, course_kit.grading.checks.check, course_kit.grading.model.report
course_kit.grading.checks.check.run_all = lambda *_: []
course_kit.grading.model.report.Report.score = 10.0
rclpy.client.Client.service_is_ready = lambda self: True
""",
}
DAEMON = """
import os, signal, time
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
def nothing_lives(worker: grading.Worker) -> Iterator[Callable[[], bool]]:
    """Whether all that a submission has started is dead; at the end of the test it has to be."""

    def look() -> bool:
        return len(processes_of(worker)) == IDLE

    yield look
    assert look()


@pytest.mark.parametrize("attack", ATTACKS)
def test_attack_earns_nothing(attack: str, grade_source: Grade, worker: grading.Worker) -> None:
    report = grade_source(ATTACKS[attack])
    assert report.score == 0.0
    assert not report.passed
    assert report.status == "crashed"
    assert {check.id for check in report.checks if check.status == "failed"} == {"offered"}
    if attack == KILLS:
        assert ("EVERYBODY" in report.stdout) == worker.ready().processes


@pytest.mark.parametrize("attack", ATTACKS)
def test_from_one_of_several_programs_that_a_launch_file_starts_it_earns_nothing(
    attack: str, tmp_path: Path, worker: grading.Worker, nothing_lives: Callable[[], bool]
) -> None:
    made = several_files.write(tmp_path / "exercises")
    mine = several_files.write_files(tmp_path / "mine", guard_py=ATTACKS[attack])
    report = grading.grade(several_files.ID, mine, worker=worker, exercises=made.parent, only="pair")
    assert report.status != "error", report.problem
    assert [(check.status, check.points) for check in report.checks] == [("failed", 0.0)]
    assert nothing_lives()


def test_among_the_testers_own_processes_no_attack_kills_more_than_its_parent() -> None:
    only_told = "import os\nos.kill = lambda victim, _: print(victim == os.getppid())\n"
    command = [sys.executable, "-c", only_told + ATTACKS[KILLS]]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (done.stdout, done.stderr) == ("True\n", "")


def test_daemons_die(grade_source: Grade, nothing_lives: Callable[[], bool]) -> None:
    report = grade_source(DAEMON.format(body="time.sleep(600)", then="time.sleep(0.5)"))
    assert report.score == 0.0
    assert nothing_lives()


def test_daemons_of_a_program_that_stays_die(
    grade_source: Grade, nothing_lives: Callable[[], bool], solution: str
) -> None:
    assert nothing_lives()
    report = grade_source(DAEMON.format(body="time.sleep(600)", then=solution))
    assert report.score == 10.0


def test_server_left_behind_does_not_help_the_next(
    grade_source: Grade, nothing_lives: Callable[[], bool], solution: str
) -> None:
    serve = f"exec({solution!r}, {{'__name__': '__main__'}})"
    grade_source(DAEMON.format(body=serve, then="time.sleep(1)"))
    assert nothing_lives()
    report = grade_source("import time\ntime.sleep(2)\n")
    assert report.score == 0.0
    assert report.checks[0].diagnosis == "start.nothing"


def test_fork_bomb(grade_source: Grade, nothing_lives: Callable[[], bool]) -> None:
    report = grade_source("import os\nwhile True:\n    os.fork()\n")
    assert report.checks[0].diagnosis == "limit.processes"
    assert nothing_lives()


def test_exit_in_a_callback(grade_source: Grade, solution: str) -> None:
    report = grade_source(
        solution.replace(
            "        response.message = problem", "        raise SystemExit\n        response.message = problem"
        )
    )
    answers = next(check for check in report.checks if check.id == "answers")
    assert answers.diagnosis == "service.exception"
    assert report.score == 1.0


def test_a_flood_of_notes_is_the_submissions_own_fault(grade_source: Grade, strict_exercises: Strict) -> None:
    """It keeps the stream of notes and dumps full for ever, which is read while the grader asks what it is doing."""
    flood = """
import os
while True:
    for descriptor in range(190, 256):
        try:
            os.write(descriptor, b'{"note": {"functions": ["x"]}}\\n' * 2000)
        except OSError:
            pass
"""
    report = grade_source(flood, exercises=strict_exercises(start_s=1.0))
    assert report.status == "crashed"
    assert report.checks[0].diagnosis == "limit.time"


def test_worker_is_left_alone(grade_source: Grade, worker: grading.Worker, solution: str) -> None:
    grade_source(ATTACKS[KILLS])
    assert len(processes_of(worker)) == IDLE
    assert grade_source(solution).score == 10.0


def test_submission_does_not_see_foreign_variables(
    grade_source: Grade, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("MY_SECRET_TOKEN", "abc123")
    path = tmp_path / "curious.py"
    path.write_text("import os\nprint(sorted(os.environ))\nprint(open('/proc/self/environ').read())\n")
    report = grading.grade("temperature_service", path)
    assert "ROS_DOMAIN_ID" in report.stdout
    assert "MY_SECRET_TOKEN" not in report.stdout
    del grade_source


DROP = """
import os, sys
home = os.environ["HOME"]
version = f"python{sys.version_info.major}.{sys.version_info.minor}"
for folder in (os.getcwd(), f"{home}/.local/lib/{version}/site-packages", os.environ["TMPDIR"] + "/more"):
    try:
        os.makedirs(folder, exist_ok=True)
        for name in ("sitecustomize.py", "usercustomize.py", "course_kit_dropped.pth"):
            with open(os.path.join(folder, name), "x") as file:
                file.write("import sys; sys.stderr.write('DROPPED')\\n")
            print("WROTE", os.path.join(folder, name))
    except OSError:
        pass
"""


def test_dropped_files_are_gone_with_the_submission(grade_source: Grade, solution: str) -> None:
    report = grade_source(DROP)
    written = [Path(line.removeprefix("WROTE ")) for line in report.stdout.splitlines() if line.startswith("WROTE")]
    assert written
    assert [path for path in written if path.exists()] == []
    after = grade_source(solution)
    assert after.score == 10.0
    assert "DROPPED" not in after.stderr


LISTEN = """
import socket, time
with socket.create_server(("0.0.0.0", {port})) as server:
    socket.create_connection(("127.0.0.1", {port}), 2).close()
    print("LISTENING", flush=True)
    server.settimeout(4)
    server.accept()
    try:
        server.accept()
        print("VISITED")
    except TimeoutError:
        pass
"""


def test_a_port_it_listens_on_is_not_to_be_reached(grade_source: Grade, worker: grading.Worker) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    over = threading.Event()
    visited: list[bool] = []
    visitor = threading.Thread(target=lambda: visited.append(visits(port, over)))
    visitor.start()
    report = grade_source(LISTEN.format(port=port))
    over.set()
    visitor.join()
    assert "LISTENING" in report.stdout
    assert report.score == 0.0
    assert not visits(port, over)
    isolated = worker.ready().network
    assert visited == [not isolated]
    assert ("VISITED" in report.stdout) == (not isolated)


def visits(port: int, over: threading.Event) -> bool:
    """Whether a connection to the port comes about before it is `over`; at least one try."""
    while not (come := comes_in(port)) and not over.wait(0.05):
        pass
    return come


def comes_in(port: int) -> bool:
    """Whether somebody listens there."""
    with socket.socket() as line:
        line.settimeout(1)
        return line.connect_ex(("127.0.0.1", port)) == 0


REACH = """
import rclpy
from course_interfaces.srv import ConvertTemperature
context = rclpy.Context()
rclpy.init(context=context, domain_id={domain})
node = rclpy.create_node("burglar", context=context)
client = node.create_client(ConvertTemperature, "/convert_temperature")
print("REACHED" if client.wait_for_service({patience}) else "ALONE", flush=True)
context.shutdown()
"""


def test_another_students_node_is_out_of_reach(
    grade_source: Grade, solution: str, domain: int, tmp_path: Path, worker: grading.Worker
) -> None:
    (tmp_path / "victim.py").write_text(solution)
    (tmp_path / "burglar.py").write_text(REACH.format(domain=domain, patience=30.0))
    environ = environment.child_environment(ROS_DOMAIN_ID=str(domain))
    with subprocess.Popen([sys.executable, tmp_path / "victim.py"], env=environ, stderr=subprocess.DEVNULL) as victim:
        try:
            # The same program outside of the sandbox gets there: otherwise nothing would be shown.
            command = [sys.executable, tmp_path / "burglar.py"]
            outside = subprocess.run(command, env=environ, capture_output=True, text=True, timeout=120, check=False)
            report = grade_source(REACH.format(domain=domain, patience=2.0))
        finally:
            victim.kill()
    assert outside.stdout == "REACHED\n", outside.stderr
    assert report.score == 0.0
    isolated = worker.ready().network
    assert report.stdout == ("ALONE\n" if isolated else "REACHED\n")

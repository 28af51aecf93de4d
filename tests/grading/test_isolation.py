"""The walls: found by trying, told truthfully, and still a fair grade where there are none."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.grading import isolation
from tests.grading.conftest import EXERCISE, ROOT
from tests.refused import COMMAND_WITHOUT_NAMESPACES, WITHOUT_NAMESPACES

if TYPE_CHECKING:
    from course_kit import grading

GRADE = """
from course_kit import grading
report = grading.grade("temperature_service", sys.argv[1], seed=3)
print(report.isolation, file=sys.stderr)
print(report.to_json())
"""
PATIENCE_S = 100.0  # against hanging only
# Everything is imported first: the interpreter may lie where nobody may read.
AS_NOBODY = """
import ctypes, json, os, sys
from pathlib import Path
from course_kit.grading import isolation, namespaces, probing, processes
from course_kit.grading.job import Job
from course_kit.grading.warden import Warden
probing.warm_up()
probing.load("temperature_service")
text = Path(sys.argv[1]).read_text()
os.environ.update(ROS_LOG_DIR="/tmp", HOME="/nonexistent")
if os.getuid() == 0:
    os.setgroups([])
    os.setresgid(65534, 65534, 65534)
    os.setresuid(65534, 65534, 65534)
    ctypes.CDLL(None).prctl(4, 1, 0, 0, 0)  # as after an exec: /proc/self belongs to the user
namespaces.adopt_orphans()
found = isolation.try_out()
job = Job("temperature_service", "run", "answer.py", 3, source=text, class_name="TemperatureService", isolation=found)
if os.fork() == 0:
    print(json.dumps({"isolation": found.to_mapping(), **Warden(job).run()}), flush=True)
    os._exit(0)
sys.exit(os.waitstatus_to_exitcode(os.wait()[1]))
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
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=100, check=False
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


def test_status_agrees_with_what_a_worker_uses(worker: grading.Worker) -> None:
    assert isolation.status() == isolation.Isolation.from_mapping(worker.ready())


def test_status_says_why_something_is_missing() -> None:
    found = isolation.status()
    assert (found.network and found.processes and found.files) or found.reason


def test_status_without_namespaces() -> None:
    done = python(WITHOUT_NAMESPACES + "from course_kit.grading import isolation\nisolation.print_trial()")
    found = json.loads(done.stdout)
    assert (found["network"], found["processes"], found["files"]) == (False, False, False)
    assert "user namespaces" in found["reason"]


def test_ordinary_users_get_the_same_walls() -> None:
    done = python(AS_NOBODY, str(ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"))
    assert done.returncode == 0, done.stderr
    outcome = json.loads(done.stdout)
    assert [result["status"] for result in outcome["results"]] == ["passed"] * len(outcome["results"])
    assert len(outcome["results"]) > 5
    restricted = Path("/proc/sys/kernel/apparmor_restrict_unprivileged_userns")
    if restricted.exists() and restricted.read_text().strip() == "1":
        assert outcome["isolation"]["reason"]
    else:
        assert outcome["isolation"] == isolation.status().to_mapping()


def test_description_names_what_does_not_hold() -> None:
    text = isolation.Isolation(network=True, reason="no PID namespace").describe()
    assert "own network" in text
    assert "read-only files" not in text
    assert "no PID namespace" in text


def test_solution_is_graded_without_namespaces() -> None:
    report, told = grade_without_namespaces(ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py")
    assert report["score"] == 10.0
    assert "own network" not in told


def test_graders_that_share_nothing_but_the_network_do_not_meet(tmp_path: Path) -> None:
    """As of two containers on their host's network: each has temporary files of its own, and no namespaces."""
    began = []
    for exercise in ("move_robot", "move_robot", "temperature_service"):
        folder = tmp_path / f"container {len(began)}"
        folder.mkdir()
        words = ("grade", exercise, str(ROOT / "solutions" / exercise / f"{exercise}.py"), "--format", "json")
        own = {"TMPDIR": str(folder), "HOME": str(folder), "XDG_STATE_HOME": str(folder), "COURSE_KIT_PROGRESS": "off"}
        began.append(
            subprocess.Popen(
                [sys.executable, "-c", COMMAND_WITHOUT_NAMESPACES, *words],
                env={**os.environ, **own},
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
            )
        )
    ended = [(*process.communicate(timeout=PATIENCE_S), process.returncode) for process in began]
    scores = [(json.loads(report)["score"], problem, code) for report, problem, code in ended]
    assert scores == [(20.0, "", 0), (20.0, "", 0), (10.0, "", 0)]


@pytest.mark.parametrize("code", ["service.exception", "limit.processes", "start.crash"])
def test_broken_submission_gets_its_code_without_namespaces(code: str) -> None:
    report, _ = grade_without_namespaces(ROOT / "tests" / "broken" / EXERCISE / f"{code}.py")
    assert {check["diagnosis"] for check in report["checks"] if check["status"] == "failed"} == {code}


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

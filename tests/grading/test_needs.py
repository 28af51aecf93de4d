"""Machines that lack what a grading needs: no zero for anybody, one sentence that says what to do, exit code 2."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from course_kit.grading import isolation_status
from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.limits import Limits
from course_kit.grading.pool import start_pool
from course_kit.grading.sandbox import machine, needs
from course_kit.process import tree
from tests.grading.conftest import EXERCISE, ROOT
from tests.refused import WITHOUT_NAMESPACES
from tests.unprivileged import as_somebody, give, reachable_folder

if TYPE_CHECKING:
    from pathlib import Path

SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"
COMMAND = "import sys\nfrom course_kit.cli.main import main\nsys.exit(main(sys.argv[1:]))\n"
LIMITED = """
import resource, sys
what, most = getattr(resource, sys.argv.pop(1)), int(sys.argv.pop(1))
soft = resource.getrlimit(what)[0]
resource.setrlimit(what, (abs(most) if most < 0 or soft == resource.RLIM_INFINITY else min(most, soft), abs(most)))
"""
# In a mount namespace of its own; where that is refused it says so.
ELSEWHERE = """
import ctypes, os, sys
from course_kit.grading.sandbox import namespaces
libc = ctypes.CDLL(None, use_errno=True)
try:
    namespaces.enter(namespaces.CLONE_NEWNS)
except OSError:
    sys.exit("REFUSED")
flags = ctypes.c_ulong(0x4000 | 0x40000)
assert libc.mount(None, b"/", None, flags, None) == 0
assert libc.mount(b"tmpfs", sys.argv.pop(1).encode(), b"tmpfs", ctypes.c_ulong(0), sys.argv.pop(1).encode()) == 0
"""
AS_NOBODY_ALONE = """
import os, sys
sys.path.insert(0, sys.argv.pop(1))
from tests.grading.sandbox import attack_modes
if os.getuid() == 0:
    attack_modes.open_the_way(sys.base_prefix)
    attack_modes.become_nobody()
attack_modes.refuse_namespaces({})
"""
FILLED = "open('/dev/shm/full', 'wb', buffering=0).write(bytes(8192))\n"

pytestmark = pytest.mark.answers


def grade(before: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    """The command on a machine to which something was done before."""
    return run([sys.executable, "-c", before + COMMAND, *arguments, "grade", EXERCISE, str(SOLUTION)])


def run(command: list[str], **variables: str) -> subprocess.CompletedProcess[str]:
    environ = {**os.environ, **variables}
    return subprocess.run(command, env=environ, capture_output=True, text=True, timeout=300, check=False)


def told(done: subprocess.CompletedProcess[str]) -> str:
    """The one line that a command says when it cannot grade."""
    assert done.returncode == 2, done.stdout + done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    *advice, last = done.stderr.splitlines()
    assert all("as root" in line for line in advice), done.stderr
    assert last.startswith("course-kit: ")
    assert last.endswith(", then grade again.")
    return last


@pytest.mark.parametrize(
    ("what", "most", "said"),
    [
        ("RLIMIT_NOFILE", 150, "150 open files here (ulimit -n), but a submission is promised 256. Allow more ("),
        ("RLIMIT_FSIZE", 1 << 20, "write files of 1024 kB here (ulimit -f)"),
    ],
)
def test_a_process_may_not_have_what_a_submission_is_promised(what: str, most: int, said: str) -> None:
    assert said in told(grade(LIMITED, what, str(most)))


def test_an_ordinary_user_may_have_too_few_processes() -> None:
    with reachable_folder() as home:
        give(home)
        user = 0 if os.geteuid() == 0 else tree.tasks_of_user(os.getuid())
        few = ["RLIMIT_NPROC", str(user + 60)]
        command = [sys.executable, "-c", LIMITED + COMMAND, *few, "grade", EXERCISE, str(SOLUTION)]
        done = run(as_somebody(*command), HOME=str(home), TMPDIR=str(home), XDG_STATE_HOME=str(home))
    said = told(done)
    assert f"You may have {user + 60} processes and threads here (ulimit -u)" in said
    assert "a grading takes up to 200" in said


def test_a_class_is_not_begun_and_goes_on_later(tmp_path: Path) -> None:
    (tmp_path / "work" / "ann").mkdir(parents=True)
    (tmp_path / "work" / "ann" / f"{EXERCISE}.py").write_text(SOLUTION.read_text())
    out = tmp_path / "out"
    command = ["class", str(tmp_path / "work"), "--exercise", EXERCISE, "--out", str(out), "--workers", "1"]
    few = run([sys.executable, "-c", LIMITED + COMMAND, "RLIMIT_NOFILE", "150", *command])
    assert "150 open files" in told(few)
    assert not list(out.glob("students/*/*"))
    done = run([sys.executable, "-c", COMMAND, *command, "--resume"])
    assert done.returncode == 0, done.stderr
    assert '"score": 10.0' in (out / "students" / "ann" / f"{EXERCISE}.json").read_text()


@pytest.mark.parametrize(
    ("place", "then", "said"),
    [("/proc", "", "/proc is missing here"), ("/dev/shm", FILLED, "/dev/shm is full")],  # noqa: S108
)
def test_a_file_system_that_is_missing_or_full(place: str, then: str, said: str) -> None:
    done = grade(ELSEWHERE + then, place, "size=4k" if then else "size=1m")
    if done.stderr.strip() == "REFUSED":
        assert not isolation_status().files
    else:
        assert said in told(done)


def test_without_files_in_memory_it_grades_all_the_same() -> None:
    without = "import os\ndel os.memfd_create\n"  # stands in for a Python that was built for an older C library
    done = run([sys.executable, "-c", without + COMMAND, "grade", EXERCISE, str(SOLUTION), "--format", "json"])
    assert done.returncode == 0, done.stderr
    assert '"score": 10.0' in done.stdout


@pytest.mark.parametrize(("most", "used", "lacks"), [("max", 50, False), ("600", 50, False), ("240", 50, True)])
def test_a_container_may_have_too_few_processes(
    most: str, used: int, lacks: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own").write_text("0::/\n")
    (tmp_path / "pids.max").write_text(f"{most}\n")
    (tmp_path / "pids.current").write_text(f"{used}\n")
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path)
    monkeypatch.setattr(machine, "_OWN_GROUPS", tmp_path / "own")
    said = " ".join(needs.describe_lacks(Limits(), guest=True))
    assert ("240 processes and threads (pids.max), 50 are there" in said) == lacks
    assert bool(said) == lacks


@pytest.mark.parametrize(("most", "slots"), [("max", 12), ("660", 3), ("200", 1)])
def test_no_more_are_graded_at_once_than_a_container_has_processes_for(
    most: str, slots: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each may take all it is promised: else a right program's thread could not be started, as its own fault."""
    (tmp_path / "own").write_text("0::/\n")
    (tmp_path / "pids.max").write_text(f"{most}\n")
    (tmp_path / "pids.current").write_text("50\n")
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path)
    monkeypatch.setattr(machine, "_OWN_GROUPS", tmp_path / "own")
    with closing(start_pool([load_exercise(EXERCISE)], 12)) as pool:
        assert pool.slots == slots


def test_gradings_side_by_side_leave_each_other_their_threads() -> None:
    """Without namespaces the kernel counts all tasks of a user together."""
    with reachable_folder() as home:
        for number in range(3):
            (home / "work" / f"s{number}").mkdir(parents=True)
            (home / "work" / f"s{number}" / f"{EXERCISE}.py").write_text(f"{SOLUTION.read_text()}\n# by s{number}\n")
        home.chmod(0o777)
        where = [str(home / "work"), "--out", str(home / "out")]
        command = ["class", *where, "--exercise", EXERCISE, "--workers", "3"]
        done = run(
            [sys.executable, "-c", AS_NOBODY_ALONE + COMMAND, str(ROOT), *command],
            HOME=str(home), TMPDIR=str(home), XDG_STATE_HOME=str(home),
        )  # fmt: skip
        assert "3 passed" in done.stderr, done.stderr
        assert done.returncode == 0, done.stderr


def test_without_namespaces_too_the_solution_is_graded_where_nothing_is_missing() -> None:
    done = grade(WITHOUT_NAMESPACES)
    assert done.returncode == 0, done.stdout + done.stderr

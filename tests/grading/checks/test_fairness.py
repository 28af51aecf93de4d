"""What a submission does to the machine or to its own clock earns it nothing."""

from __future__ import annotations

import shlex
import sys
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    Grade = Callable[[str, str], grading.Report]

pytestmark = [pytest.mark.answers]


@pytest.fixture
def grade(worker: grading.Worker, tmp_path: Path) -> Grade:
    """Grades a text as a submission to an exercise."""

    def run(exercise: str, source: str) -> grading.Report:
        path = tmp_path / "answer.py"
        path.write_text(source)
        return grading.grade(exercise, path, worker=worker, seed=3)

    return run


def changed(exercise: str, *changes: tuple[str, str]) -> str:
    """The solution with texts replaced, each of which stands in it once."""
    source = (ROOT / "solutions" / exercise / f"{exercise}.py").read_text()
    for old, new in changes:
        assert source.count(old) == 1, old
        source = source.replace(old, new)
    return source


def failed(report: grading.Report) -> dict[str, str | None]:
    return {check.id: check.diagnosis for check in report.checks if check.status == "failed"}


# Replaces clock_gettime in the C library's memory by code that makes the system call, and then, for CLOCK_REALTIME,
# hands out the seconds and nanoseconds of CELL unless they are 0: what a preloaded library does, without a compiler.
FORGER = """
import ctypes, mmap, platform, time

CELL = (ctypes.c_int64 * 2)()
ADDRESS = ctypes.addressof(CELL).to_bytes(8, "little")
CODE = {
    "x86_64": (
        "b8e4000000"  # mov eax, 228: clock_gettime
        "0f05"  # syscall
        "85ff"  # test edi, edi: CLOCK_REALTIME is 0
        "751d"  # jnz to ret
        "48ba", "488b0a"  # mov rdx, CELL; mov rcx, [rdx]
        "4885c9"  # test rcx, rcx
        "740b"  # jz to ret
        "48890e"  # mov [rsi], rcx
        "488b4a08"  # mov rcx, [rdx + 8]
        "48894e08"  # mov [rsi + 8], rcx
        "c3"  # ret
    ),
    "aarch64": (
        "e90300aa"  # mov x9, x0
        "280e80d2"  # mov x8, 113: clock_gettime
        "010000d4"  # svc 0
        "e90000b5"  # cbnz x9, to ret
        "ea000058"  # ldr x10, CELL
        "4b0140f9"  # ldr x11, [x10]
        "8b0000b4"  # cbz x11, to ret
        "2b0000f9"  # str x11, [x1]
        "4b0540f9"  # ldr x11, [x10, 8]
        "2b0400f9"  # str x11, [x1, 8]
        "c0035fd6",  # ret
        "",
    ),
}
before, after = map(bytes.fromhex, CODE[platform.machine()])
libc = ctypes.CDLL(None)
place = ctypes.cast(libc.clock_gettime, ctypes.c_void_p).value
page = place & -mmap.PAGESIZE
assert libc.mprotect(ctypes.c_void_p(page), ctypes.c_size_t(2 * mmap.PAGESIZE), 7) == 0
code = before + ADDRESS + after
ctypes.memmove(place, code, len(code))
CELL[0] = 1
assert int(time.time()) == 1
CELL[0] = 0
"""
TELLS = """
            self.tell(goal_handle, remaining, whole_way)
            self.robot.step_towards(*target)
        self.tell(goal_handle, remaining, whole_way)  # the last one says that the robot is there
"""
KEEPS_AND_FORGES = """
            progress = 1.0 - remaining / whole_way
            feedback = MoveRobot.Feedback(position=self.point(), distance_remaining=remaining, progress=progress)
            story.append((time.time_ns(), feedback))
            self.robot.step_towards(*target)
        story.append((time.time_ns(), MoveRobot.Feedback(position=self.point(), progress=1.0)))
        for when, feedback in story:
            CELL[:] = divmod(when, 10**9)
            goal_handle.publish_feedback(feedback)
        CELL[0] = 0
"""


BEGINS = "        begin = self.robot.position\n        target"


def test_feedback_counts_when_it_comes_whatever_its_publishers_clock_says(grade: Grade) -> None:
    changes = (
        ("import math\n", f"{FORGER}\nimport math\n"),
        (BEGINS, f"        story = []\n{BEGINS}"),
        (TELLS, KEEPS_AND_FORGES),
    )
    report = grade("move_robot", changed("move_robot", *changes))
    assert failed(report) == {"feedback": "action.late_feedback"}
    assert report.score == 16.5


SLOW = """
        self.asked = getattr(self, "asked", 0) + 1
        if self.asked == 45:
            starve()
        if self.asked > 45:  # the other checks are over
            time.sleep(0.2)
"""
ANSWERS = '        """Answer one request; a refusal carries its reason."""\n'
IMPORTS = "import hashlib\nimport os\nimport signal\nimport threading\nimport time\n"
UNNOTICED = "with children too short to be noticed"
STARVERS = {
    "with twelve busy children": """
def starve():
    for _ in range(12):
        if os.fork() == 0:
            while True:
                pass
""",
    UNNOTICED: """
def fork_without_end():
    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
    while True:
        if os.fork() == 0:
            end = time.process_time() + 0.014
            while time.process_time() < end:
                pass
            os._exit(0)
        try:
            os.wait()
        except ChildProcessError:  # it has ended
            pass

def wait_for_a_processor():
    os.sched_setaffinity(0, [min(os.sched_getaffinity(0))])
    os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), 19)
    much = bytes(2**27)
    while True:
        hashlib.sha256(much)  # others may run Python meanwhile

def starve():
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # they are not waited for, and nobody is told what they have used
    for begin in (fork_without_end, wait_for_a_processor):
        threading.Thread(target=begin, daemon=True).start()
""",
}


def starving(starver: str) -> str:
    changes = (("import math\n", f"import math\n{IMPORTS}{STARVERS[starver]}"), (ANSWERS, ANSWERS + SLOW))
    return changed("temperature_service", *changes)


@pytest.mark.parametrize("starver", STARVERS)
def test_starving_itself_buys_a_slow_program_no_patience(starver: str, grade: Grade) -> None:
    report = grade("temperature_service", starving(starver))
    assert failed(report) == {"fifty_calls": "service.blocks"}
    assert report.score == 8.5


def test_starving_itself_buys_a_command_no_patience(tmp_path: Path) -> None:
    program = tmp_path / "answer.py"
    program.write_text(starving(UNNOTICED))
    report = grading.grade("temperature_service", exec_command=shlex.join([sys.executable, str(program)]), seed=3)
    assert failed(report) == {"fifty_calls": "service.blocks"}
    assert report.score == 8.5

"""What is read out of a program's own words: tracebacks, stacks, causes."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.diagnosis import causes
from course_kit.grading.diagnosis.tracebacks import Frame, last_exception, read_activity
from course_kit.grading.model.job import Job, ProcessStatus
from course_kit.grading.model.submission import Submission
from course_kit.grading.sandbox.output_collector import KEPT, BoundedOutput

if TYPE_CHECKING:
    from pathlib import Path

# Of two processes, one through the other, as those of a fork bomb come.
OF_MANY_AT_ONCE = (
    "Traceback (mostTraceback (most\nBlockingIOError: [Errno 11] Resource temporarily unavailable recent\n"
)

TRACE = """[INFO] something
Traceback (most recent call last):
  File "answer.py", line 9, in <module>
    main()
Traceback (most recent call last):
  File "/lib/rclpy/executors.py", line 111, in await_or_execute
    return callback(*args)
           ^^^^^^^^^^^^^^^
  File "answer.py", line 3, in convert
    return 1 / 0
           ~~^~~
  File "/lib/other.py", line 7, in deep
ZeroDivisionError: division by zero
[INFO] the end
"""
PROGRAM = Submission("answer.py", "answer.py", "a = 1\nb = 2\nreturn 1 / 0\n")
JOB = Job("course_kit.graders.temperature_service", "run", 1, PROGRAM)
CALLS = """Thread 0x00007f1 [worker] (most recent call first):
  File "/usr/lib/threading.py", line 5 in wait
  File "/lib/rclpy/client.py", line 80 in call
  File "answer.py", line 20 in convert
  File "/lib/rclpy/executors.py", line 111 in await_or_execute
  File "/lib/rclpy/executors.py", line 456 in _execute
  File "/lib/rclpy/task.py", line 240 in __call__
  File "/lib/rclpy/executors.py", line 800 in _spin_once_impl
  File "answer.py", line 30 in main
"""


def test_last_traceback_and_the_learners_own_line() -> None:
    raised = last_exception(TRACE, ("answer.py",))
    assert raised is not None
    assert raised.describe() == "ZeroDivisionError: division by zero"
    assert raised.own is not None
    assert (raised.own.line, raised.own.function) == (3, "convert")
    assert len(raised.frames) == 3


@pytest.mark.parametrize(
    "mention",
    [
        "Exception ignored in: <function Executor.__del__ at 0x7f1>",
        "Exception ignored while calling deallocator <function Executor.__del__ at 0x7f1>:",  # since Python 3.14
    ],
)
def test_a_traceback_that_python_only_mentions_is_not_what_a_program_died_of(mention: str) -> None:
    ignored = (
        f'{mention}\nTraceback (most recent call last):\n  File "/lib/rclpy/executors.py", line 258, in __del__\n'
        "    self._sigint_gc.destroy()\nrclpy._rclpy_pybind11.InvalidHandle: destruction was requested\n"
    )
    assert last_exception(ignored, ("answer.py",)) is None
    raised = last_exception(TRACE + ignored, ("answer.py",))
    assert raised is not None
    assert raised.describe() == "ZeroDivisionError: division by zero"


def test_a_callback_that_waits_for_ros_says_more_than_one_that_ticks() -> None:
    lines = CALLS.replace("line 20 in convert", "line 25 in tick").splitlines(keepends=True)
    seen = read_activity("".join([CALLS, lines[0], *lines[3:]]), ("answer.py",))
    assert seen.spinning
    assert seen.waits_for_ros
    assert seen.callback == Frame("answer.py", 20, "convert")


@pytest.mark.parametrize(
    ("process", "code"),
    [
        (ProcessStatus(running=False, exit_code=1, stderr=TRACE), "start.crash"),
        (ProcessStatus(running=False, exit_code=3), "start.exit"),
        (ProcessStatus(running=False, signal=11), "start.exit"),
        (ProcessStatus(running=False, limit="memory"), "limit.memory"),
        (ProcessStatus(running=False, exit_code=1, stderr=OF_MANY_AT_ONCE), "limit.processes"),
        (ProcessStatus(running=False, exit_code=0, notes={"functions": ["f"]}), "start.nothing"),
        (ProcessStatus(running=False, stderr=TRACE.replace("ZeroDivisionError", "MemoryError")), "limit.memory"),
        (
            ProcessStatus(
                running=False,
                stderr="Traceback (most recent call last):\nModuleNotFoundError: No module named 'nunpy'\n",
            ),
            "start.import",
        ),
        (
            ProcessStatus(
                running=False, stderr="Traceback (most recent call last):\nRuntimeError: can't start new thread\n"
            ),
            "limit.processes",
        ),
    ],
)
def test_why_a_start_failed(process: ProcessStatus, code: str) -> None:
    assert causes.explain_start(process, JOB)[0] == code


@pytest.mark.parametrize(
    ("problem", "nearest"),
    [
        ("ModuleNotFoundError: No module named 'course_interface'", "course_interfaces"),
        ("ModuleNotFoundError: No module named 'nunpy.linalg'", "numpy"),
        ("ImportError: cannot import name 'ConvertTemperatur' from 'course_interfaces.srv' (x)", "ConvertTemperature"),
        ("ImportError: cannot import name 'Strin' from 'std_msgs.msg' (x)", "String"),
        ("ImportError: cannot import name 'Nod' from 'rclpy.node' (x)", "Node"),
        ("ImportError: cannot import name 'SimulatedRobo' from 'course_kit.robot' (x)", "SimulatedRobot"),
        ("ImportError: cannot import name 'sqtr' from 'math' (x)", "sqrt"),
    ],
)
def test_nearest_import(problem: str, nearest: str) -> None:
    process = ProcessStatus(running=False, stderr=f"Traceback (most recent call last):\n{problem}\n")
    assert f"nearest name is {nearest}." in causes.explain_start(process, JOB)[1]


def test_source_line_in_a_notebook() -> None:
    job = replace(
        JOB, text=Submission("answer.ipynb", "answer.py", "a = 1\nb = 2\n", places=(("cell 2", 1), ("In[5]", 1)))
    )
    assert causes.source_line(job, 2) == "In[5], line 2: b = 2"
    assert causes.source_line(JOB, 99) == "line 99"


def test_output_keeps_beginning_and_end() -> None:
    output = BoundedOutput()
    for number in range(3 * KEPT // 8 + 1):
        output.add(b"%07d " % number)
    text = output.text()
    assert text.startswith("0000000 ")
    assert text.endswith(f"{3 * KEPT // 8:07d} ")
    assert f"[... {output.count - 2 * KEPT} bytes left out ...]" in text


def test_output_is_harmless_text() -> None:
    output = BoundedOutput()
    output.add("ä\x1b[31mred\x00\r\n\t\xff".encode() + b"\xff\xfe")
    text = output.text()
    assert "\x1b" not in text
    assert "\x00" not in text
    assert text.startswith("ä")
    assert "\n\t" in text


@pytest.mark.parametrize("module", ["harmful", "harmful.msg", "harmful_msgs", "rclpyy", "course_kit.robott"])
def test_a_module_that_a_traceback_names_is_not_run(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The submission has written it, and importing is running."""
    top, _, inner = module.partition(".")
    (tmp_path / top).mkdir(exist_ok=True)
    for name in ("__init__", inner or "other"):
        (tmp_path / top / f"{name}.py").write_text(
            f"open({str(tmp_path / 'trace')!r}, 'w').close()\nraise SystemExit\n"
        )
    monkeypatch.syspath_prepend(str(tmp_path))
    stderr = f"Traceback (most recent call last):\nImportError: cannot import name 'x' from '{module}' (y)\n"
    if top == "course_kit":
        monkeypatch.delitem(sys.modules, module, raising=False)
    assert causes.explain_start(ProcessStatus(running=False, exit_code=1, stderr=stderr), JOB)[0] == "start.import"
    assert not (tmp_path / "trace").exists()

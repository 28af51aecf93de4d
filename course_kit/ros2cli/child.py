"""Runs a program from within a kernel and shows what it prints in the cell."""

from __future__ import annotations

import signal
import subprocess
import sys

from course_kit import environment

_GRACE = 10.0  # seconds to end in after a Ctrl-C; `ros2 launch` itself needs some to end its children


def run_and_show(command: list[str]) -> int:
    """Run `command` until it ends; an interrupt of the cell is passed on. The exit code."""
    process = subprocess.Popen(
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment.child_environment(PYTHONUNBUFFERED="1", PYTHON_COLORS="0"),
        start_new_session=True,  # the kernel passes the interrupt on; it must not come twice
    )
    assert process.stdout is not None  # noqa: S101 - for the type checker: it is a pipe
    with process.stdout as lines:
        try:
            for line in lines:
                sys.stdout.write(line)
            return process.wait()
        except KeyboardInterrupt:
            process.send_signal(signal.SIGINT)
            return _end(process)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()


def _end(process: subprocess.Popen[str]) -> int:
    try:
        said, _ = process.communicate(timeout=_GRACE)
    except subprocess.TimeoutExpired:
        process.kill()
        said, _ = process.communicate()
    sys.stdout.write(said)
    return process.returncode

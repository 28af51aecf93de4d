"""Runs the course kit's `ros2`, and the nodes it finds, which are processes."""

from __future__ import annotations

import io
import os
import signal
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

import pytest

from course_kit import environment
from course_kit.ros2cli import cli
from tests.waiting import wait_until

if TYPE_CHECKING:
    from typing_extensions import Self

HERE = Path(__file__).resolve().parent
GOLDEN = HERE / "golden"
PROGRAMS = HERE.parent / "lesson_programs"
OURS = [sys.executable, "-m", "course_kit.ros2cli"]
PATIENCE = 60.0


class Ros2:
    """The command in one ROS domain, and the programs started there.

    Args:
        domain: the ROS domain.
        folder: where commands are run.
    """

    def __init__(self, domain: int, folder: Path) -> None:
        self.folder = folder
        self.environ = environment.child_environment(ROS_DOMAIN_ID=str(domain))
        self._programs: list[subprocess.Popen[str]] = []
        self._files: list[TextIO] = []

    def __call__(self, *words: str, **environ: str) -> subprocess.CompletedProcess[str]:
        """Run the command in this process, which is a tenth of the work of another Python with rclpy."""
        stdout, stderr = io.StringIO(), io.StringIO()
        with pytest.MonkeyPatch.context() as patch, redirect_stdout(stdout), redirect_stderr(stderr):
            patch.chdir(self.folder)
            for name, value in {**self.environ, **environ}.items():
                patch.setenv(name, value)
            code = cli.run_command(words)
        return subprocess.CompletedProcess(words, code, stdout.getvalue(), stderr.getvalue())

    def process(self, *words: str, **environ: str) -> subprocess.CompletedProcess[str]:
        """Run the command as a shell does: where it starts programs, and where its start and its end are tested."""
        return subprocess.run(
            [*OURS, *words],
            cwd=self.folder,
            env={**self.environ, **environ},
            capture_output=True,
            text=True,
            timeout=PATIENCE,
            check=False,
        )

    def begin(self, *command: str) -> subprocess.Popen[str]:
        """Start a program whose stdout and stderr can be read."""
        program = subprocess.Popen(
            command, cwd=self.folder, env=self.environ, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        self._programs.append(program)
        return program

    def start(self, script: Path, node: str, *arguments: str) -> subprocess.Popen[str]:
        """Start a node whose output nobody reads, and wait until it is on the graph."""
        errors = (self.folder / f"{script.stem}.stderr").open("w+")
        self._files.append(errors)
        program = subprocess.Popen(
            [sys.executable, str(script), *arguments],
            cwd=self.folder,
            env=self.environ,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            text=True,
        )
        self._programs.append(program)

        def is_there() -> bool:
            assert program.poll() is None, (errors.seek(0), errors.read())
            return node in self("node", "list").stdout.splitlines()

        wait_until(is_there, f"{node} on the graph")
        return program

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        """End what was started here, the daemon too."""
        for program in self._programs:
            if program.poll() is None:
                program.kill()
            program.communicate()
        for errors in self._files:
            errors.close()
        self("daemon", "stop")


def lines_until(program: subprocess.Popen[str], wanted: str) -> list[str]:
    """The lines of a program's stdout up to the first that holds `wanted`."""
    assert program.stdout is not None
    lines = []
    for line in program.stdout:
        lines.append(line)
        if wanted in line:
            return lines
    raise AssertionError(f"{wanted!r} was never printed; stdout: {''.join(lines)}")


def interrupt(program: subprocess.Popen[str]) -> tuple[str, str]:
    """Ctrl-C, and what the program says after it."""
    program.send_signal(signal.SIGINT)
    assert program.stdout is not None
    # Not communicate(): it would not know of what `lines_until` has read ahead of its line.
    stdout = program.stdout.read()
    _, stderr = program.communicate(timeout=PATIENCE)
    return stdout, stderr


def is_alive(process_id: int) -> bool:
    try:
        os.kill(process_id, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{process_id}/stat").read_text().rpartition(")")[2].split()[0]
    return state != "Z"

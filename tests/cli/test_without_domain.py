"""No ROS domain to work in, because all are taken or ROS_DOMAIN_ID is impossible: every command and magic says so.

One sentence that says what to do, no traceback, and nothing that could have been done without a domain is left undone.
"""

from __future__ import annotations

import json
import os
import secrets
import subprocess
import sys
from typing import TYPE_CHECKING
from unittest import mock

import pytest

from course_kit import environment
from course_kit.environment import domains
from course_kit.grading import advice_for_root, isolation_status
from tests.course_copy import SOLUTION, TEMPERATURE
from tests.lab.kernel import Kernel
from tests.refused import COMMAND_WITHOUT_NAMESPACES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

TAKEN = "All ROS domains from 1 to 101 on this machine are in use"
IMPOSSIBLE = "ROS_DOMAIN_ID is set to '300', but it must be a whole number from 0 to 232"
OWN = ("ROS_DOMAIN_ID", "COURSE_KIT_DOMAIN_ID")
# Runs at the start of every Python: leases apart from those of others on this machine.
SITE = """
import functools
from course_kit import environment
from course_kit.environment import domains
environment.Leases = domains.Leases = functools.partial(domains.Leases, {scope!r}, frozenset)
"""
COURSE = ("-m", "course_kit.cli.main")
ROS2 = ("-m", "course_kit.ros2cli")
AS_ROOT = f"course-kit: {advice_for_root()}\n" if os.geteuid() == 0 else ""
START = """
from course_kit import lab
from rclpy.node import Node
lab.start(Node, "mine")
"""


class Machine:
    """A machine of which a test takes domains."""

    def __init__(self, folder: Path) -> None:
        scope = f"test {secrets.token_hex(8)}"
        self.leases = domains.Leases(scope, frozenset)
        (folder / "sitecustomize.py").write_text(SITE.format(scope=scope))
        self.environ = {name: value for name, value in os.environ.items() if name not in OWN}
        self.environ["PYTHONPATH"] = str(folder)
        self.taken: list[domains.Lease] = []
        self.ours = [environment.Leases().lease_exclusive() for _ in range(2)]  # of the real ones

    def take_all(self) -> None:
        self.taken += [self.leases.lease_exclusive() for _ in range(domains.FIRST, domains.LAST + 1)]

    def give_back(self) -> None:
        """Only what nobody else uses in reality: nodes of others are on the rest."""
        for lease in self.taken:
            if lease.domain_id in {ours.domain_id for ours in self.ours}:
                lease.release()

    def run(self, *command: object, **variables: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *map(str, command)],
            env={**self.environ, **variables},
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Machine]:
    (tmp_path / "site").mkdir()
    made = Machine(tmp_path / "site")
    yield made
    for lease in (*made.taken, *made.ours):
        lease.release()


def all_taken(machine: Machine) -> str:
    machine.take_all()
    return TAKEN


def all_taken_since(machine: Machine) -> str:
    """As in a terminal of JupyterLab, whose domain was given to somebody else after its last kernel had ended."""
    machine.environ.update(ROS_DOMAIN_ID="7", COURSE_KIT_DOMAIN_ID="7")
    return all_taken(machine)


def impossible(machine: Machine) -> str:
    machine.environ["ROS_DOMAIN_ID"] = "300"
    return IMPOSSIBLE


@pytest.fixture(params=[all_taken, impossible])
def sentence(machine: Machine, request: pytest.FixtureRequest) -> str:
    """What has to be said on this machine."""
    problem: Callable[[Machine], str] = request.param
    return problem(machine)


@pytest.mark.parametrize(
    ("command", "exit_code"),
    [
        ((*COURSE, "lab", "--version"), 2),
        ((*ROS2, "service", "list"), 1),
        (("-c", "import rclpy"), 0),
    ],
)
def test_a_command_says_so_in_one_sentence(
    machine: Machine, sentence: str, command: tuple[str, ...], exit_code: int
) -> None:
    done = machine.run(*command)
    assert done.returncode == exit_code, done.stderr
    assert done.stderr.count(sentence) == 1
    # Where these tests run as root in a container, starting JupyterLab says so first.
    assert len([line for line in done.stderr.splitlines() if "you are root in a container" not in line]) == 1
    assert done.stdout == ""


def test_the_tab_key_offers_nothing_then(machine: Machine, tmp_path: Path) -> None:
    machine.take_all()
    line, out = "ros2 service type /", tmp_path / "offered"
    asked = {
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "COMP_TYPE": "9",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(out),
    }
    done = machine.run("-c", "from course_kit.ros2cli.cli import main; main()", _ARGCOMPLETE="1", **asked)
    assert (done.returncode, done.stderr, out.read_text().strip()) == (0, "", "")


def test_a_real_ros2_is_not_started_on_a_domain_that_is_not_ours(machine: Machine, tmp_path: Path) -> None:
    sentence = all_taken_since(machine)
    stand_in = tmp_path / "ros2"
    stand_in.write_text("#!/bin/sh\necho started\n")
    stand_in.chmod(0o755)
    done = machine.run("-c", "from course_kit.ros2cli.cli import main; main()", PATH=f"{tmp_path}:/usr/bin:/bin")
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr.count(sentence) == len(done.stderr.splitlines()) == 1


def test_the_doctor_says_so_and_looks_at_all_the_rest(machine: Machine) -> None:
    sentence = impossible(machine)
    done = machine.run(*COURSE, "doctor")
    assert done.returncode == 1
    assert sentence in " ".join(done.stdout.split())
    assert done.stdout.count("BAD") == 1
    assert "rclpy" in done.stdout
    assert "Error" not in done.stdout
    assert done.stderr == ""


@pytest.mark.answers
def test_a_notebook_says_so_and_grades(machine: Machine, tmp_path: Path) -> None:
    sentence = all_taken(machine)
    with mock.patch.dict(os.environ, machine.environ, clear=True), Kernel(cwd=tmp_path) as kernel:
        for cell, at_import in (("%load_ext course_kit", 0), (START, 1), ("%ros2 service list", 0)):
            shown = kernel.run(cell)
            assert sentence in shown.error
            assert len(shown.error.splitlines()) == 1
            assert len(shown.stderr.splitlines()) == at_import
        kernel.run(f"%%submission {TEMPERATURE}\n{SOLUTION.read_text()}")
        graded = kernel.run(f"%grade {TEMPERATURE}").result["text/plain"]
        assert "10 of 10 points" in graded or (not isolation_status().network and "no ROS domain" in graded)
        machine.give_back()
        works = kernel.run("%env ROS_DOMAIN_ID=\n%load_ext course_kit\n" + START)
        assert works.ok, works


def test_an_impossible_number_that_is_set_in_a_notebook_is_named(domain: int, tmp_path: Path) -> None:
    assert domain
    with Kernel(cwd=tmp_path) as kernel:
        assert kernel.run("%load_ext course_kit\nfrom course_kit import lab").ok
        kernel.run("import os\nos.environ['ROS_DOMAIN_ID'] = '300'")
        for cell in (
            START,
            "%%ros_script a\nprint(1)",
            "%ros2 run a a",
            f"!'{sys.executable}' -m course_kit.ros2cli node list",
        ):
            shown = kernel.run(cell)
            assert IMPOSSIBLE in shown.stdout + shown.stderr + shown.error
            assert "Traceback" not in shown.stdout + shown.stderr + shown.error


def test_a_program_does_not_use_a_domain_that_is_somebody_elses_by_now(machine: Machine) -> None:
    all_taken_since(machine)
    done = machine.run("-c", "import rclpy; rclpy.init(); print(rclpy.get_default_context().get_domain_id())")
    assert done.stdout == "0\n"
    assert "Until then this program uses domain 0." in done.stderr


@pytest.mark.answers
def test_what_has_a_network_of_its_own_is_graded_all_the_same(machine: Machine) -> None:
    machine.take_all()
    done = machine.run(*COURSE, "grade", TEMPERATURE, SOLUTION, "--format", "json", COURSE_KIT_PROGRESS="off")
    report = json.loads(done.stdout)
    if isolation_status().network:
        assert (done.returncode, report["score"], done.stderr) == (0, 10.0, AS_ROOT)
    else:
        assert (done.returncode, report["status"]) == (2, "error")


@pytest.mark.answers
def test_without_a_network_of_its_own_it_is_an_error_of_the_machine_and_no_zero(machine: Machine) -> None:
    machine.take_all()
    words = ("grade", TEMPERATURE, SOLUTION, "--format", "json")
    done = machine.run("-c", COMMAND_WITHOUT_NAMESPACES, *words, COURSE_KIT_PROGRESS="off")
    report = json.loads(done.stdout)
    assert (done.returncode, report["status"], report["checks"]) == (2, "error", [])
    assert "no ROS domain is free" in report["stderr"]
    assert "grade again" in report["stderr"]
    assert done.stderr == AS_ROOT


@pytest.mark.answers
def test_a_class_goes_on_and_the_next_run_grades_what_got_no_domain(machine: Machine, tmp_path: Path) -> None:
    for name, file in (("ada", SOLUTION.read_text()), ("bob", "nothing ("), ("eve", SOLUTION.read_text() + "\n")):
        (tmp_path / "in" / name).mkdir(parents=True)
        (tmp_path / "in" / name / f"{TEMPERATURE}.py").write_text(file)
    words = ("class", tmp_path / "in", "--exercise", TEMPERATURE, "--out", tmp_path / "out", "--workers", 2)

    def states() -> dict[str, tuple[str, float]]:
        found = (tmp_path / "out/students").glob("*/*.json")
        reports = {path.parent.name: json.loads(path.read_text())["report"] for path in found}
        return {name: (report["status"], report["score"]) for name, report in reports.items()}

    machine.take_all()
    first = machine.run("-c", COMMAND_WITHOUT_NAMESPACES, *words)
    assert first.returncode == 2, first.stderr
    assert states() == {"ada": ("error", 0.0), "bob": ("crashed", 0.0), "eve": ("error", 0.0)}
    machine.give_back()
    second = machine.run("-c", COMMAND_WITHOUT_NAMESPACES, *words, "--resume")
    assert second.returncode == 0, second.stderr
    assert states() == {"ada": ("graded", 10.0), "bob": ("crashed", 0.0), "eve": ("graded", 10.0)}

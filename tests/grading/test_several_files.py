"""An exercise whose submission is several programs, a launch file and a parameter file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.classroom.exports.report_page import render_page
from course_kit.grading.model.exercise import read_exercise
from course_kit.grading.reading import Reader, copy_file, starter_identities
from course_kit.grading.render.text import render_text
from tests import several_files
from tests.several_files import ID, PARTS

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


@pytest.fixture
def grade(tmp_path: Path, worker: grading.Worker) -> Callable[[Path], grading.Report]:
    made = several_files.write(tmp_path / "exercises")
    return lambda path: grading.grade(ID, path, worker=worker, exercises=made.parent, seed=3)


def test_parts_graded_side_by_side_are_all_checks_of_the_exercise(tmp_path: Path) -> None:
    made = several_files.write(tmp_path / "exercises")
    report = grading.grade(ID, made / "solution", exercises=made.parent, seed=3)
    assert [(check.id, check.status) for check in report.checks] == [(part, "passed") for part in PARTS], report


def test_a_missing_file_and_one_that_is_no_python_cost_only_what_needs_them(
    tmp_path: Path, grade: Callable[..., grading.Report]
) -> None:
    report = grade(several_files.write_files(tmp_path / "mine", gate_py="def ("))
    assert [check.status for check in report.checks] == ["failed", "passed", "failed"]
    assert "line 1" in report.checks[0].message
    report = grade(several_files.write_files(tmp_path / "yours", guard_py=None))
    assert [check.status for check in report.checks] == ["passed", "failed", "failed"]
    assert "The file guard.py is missing" in report.checks[1].message
    assert report.submission.endswith("yours (missing: guard.py)")


def test_what_the_launch_file_starts_is_explained_by_its_own_file_and_line(
    tmp_path: Path, grade: Callable[..., grading.Report]
) -> None:
    step = "def step(self):\n"
    tired = several_files.FILES["guard.py"].replace(step, f"{step}        raise ValueError('tired')\n")
    report = grade(several_files.write_files(tmp_path / "mine", guard_py=tired))
    together = report.checks[-1]
    assert together.status == "failed"
    assert "ValueError: tired in guard.py, line 15: raise ValueError('tired')" in together.message
    assert str(together.steps[0]) == "grader -> pair.launch: start pair.launch.py with pace:=3.5"
    assert "graph     gate: serves /gate/open" in render_text(report)
    assert report.checks[0].graph is None
    page = render_page(report, "Ann")
    assert page.count('class="ck-flow"') == sum(check.status == "failed" for check in report.checks)
    assert "<li>gate: serves /gate/open</li>" in page
    stubborn = several_files.FILES["guard.py"].replace('super().__init__("guard")', "raise ValueError('no feet')")
    report = grade(several_files.write_files(tmp_path / "hers", guard_py=stubborn))
    together = next(check for check in report.checks if check.id == "pair")
    assert "ValueError: no feet in guard.py, line 9: raise ValueError('no feet')" in together.message
    report = grade(several_files.write_files(tmp_path / "yours", pair_launch_py="import nix"))
    together = next(check for check in report.checks if check.id == "pair")
    assert "pair.launch.py, line 1: No module named 'nix'." in together.message


def test_a_notebook_and_a_zip_hold_the_same_files(tmp_path: Path) -> None:
    exercise = read_exercise(several_files.write(tmp_path))
    (tmp_path / "it.ipynb").write_text(several_files.notebook(guard_py=None))
    packed = several_files.zipped(tmp_path / "it.zip", guard_py=None)
    alone, unusable = tmp_path / "it" / "gate.py", tmp_path / "my gate.py"
    unusable.write_text(alone.read_text())
    with Reader() as reader:
        read = []
        for path in (tmp_path / "it", packed, tmp_path / "it.ipynb", alone, unusable):
            with copy_file(path, several=True) as copy:
                read.append(reader.read(copy, exercise))
    folder, archive, cells, one, none = (
        {name: text.source.strip() for name, text in each.files.items()} for each in read
    )
    assert folder == archive == cells
    assert sorted(folder) == ["gate.py", "pair.launch.py", "pair.yaml"]
    assert (one, none) == ({"gate.py": folder["gate.py"]}, {})
    assert len(starter_identities(exercise)) == 1
    assert read[2].files["pair.yaml"].describe_line(2) == "cell 3, line 3"


def test_a_program_of_a_launch_file_begins_with_the_signals_of_python(
    tmp_path: Path, grade: Callable[..., grading.Report]
) -> None:
    ignored = "int(open('/proc/self/status').read().split('SigIgn:')[1].split()[0], 16)"
    looks = f"assert {ignored} & 0x1001000 == 0x1001000  # SIGPIPE, SIGXFSZ\n{several_files.FILES['guard.py']}"
    assert grade(several_files.write_files(tmp_path / "mine", guard_py=looks)).score == 5


def test_the_programs_of_a_launch_file_share_the_memory_that_one_may_have(
    tmp_path: Path, grade: Callable[..., grading.Report]
) -> None:
    large = {name: f"held = b'x' * {110 << 20}\n{several_files.FILES[name]}" for name in ("gate.py", "guard.py")}
    report = grade(several_files.write_files(tmp_path / "mine", gate_py=large["gate.py"], guard_py=large["guard.py"]))
    assert {check.id: check.diagnosis for check in report.checks} == {
        "gate": None,
        "guard": None,
        "pair": "limit.memory",
    }

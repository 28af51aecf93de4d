"""Our test file for Otter-Grader, run as Otter runs it, but without Otter; tests/otter has a real one."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import environment, grading
from course_kit.cli import main
from course_kit.grading import CheckReport, Report
from course_kit.grading.model.exercise import list_exercise_ids, load_exercise
from course_kit.integrations import otter
from course_kit.otter import feedback
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator

EXERCISE = "temperature_service"
QUICK = "pattern_choice"  # written answers are only read
ROOT = environment.checkout_folder() or Path()
PARTIAL = ROOT / "tests/broken" / EXERCISE / "validation.missing.py"
# All that the file asks of Otter: a decorator that keeps a function with its name and its points.
STAND_IN = """
import sys, types

class test_case:
    def __init__(self, name, points):
        self.name, self.points = name, points

    def __call__(self, function):
        self.function = function
        return self

sys.modules.setdefault("otter.test_files", types.ModuleType("otter.test_files")).test_case = test_case
"""
# What Otter does with the file; prints the points, the feedback of failed cases, and how many gradings it took.
RUN = """
import json
from course_kit import grading

gradings = []

def counted(*words, real=grading.grade, **options):
    gradings.append(words)
    return real(*words, **options)

grading.grade = counted

def run(text):
    names, points, failed = {}, 0, {}
    gradings.clear()
    exec(text, names)
    assert names["OK_FORMAT"] is False
    for case in [value for value in names.values() if isinstance(value, test_case)]:
        try:
            case.function()
        except Exception as problem:
            failed[case.name] = str(problem)
        else:
            points += case.points
    print(json.dumps([points, failed, len(gradings)]))
"""
pytestmark = pytest.mark.answers


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    with Kernel(cwd=tmp_path_factory.mktemp("kernel")) as running:
        for cell in ("%load_ext course_kit", STAND_IN, RUN):
            assert running.run(cell).ok
        yield running


def outcome(kernel: Kernel, exercise: str) -> tuple[float, dict[str, str], int]:
    shown = kernel.run(f"run({otter.case_file(exercise, 1)!r})")
    assert shown.ok, shown.error
    points, failed, gradings = json.loads(shown.stdout)
    return points, failed, gradings


def cases(exercise: str, patch: pytest.MonkeyPatch) -> list[Any]:
    """The test cases that Otter finds in the file."""
    names: dict[str, Any] = {}
    patch.setitem(sys.modules, "otter.test_files", ModuleType("otter.test_files"))
    exec(STAND_IN, names)  # noqa: S102 - our own text
    exec(otter.case_file(exercise), names)  # noqa: S102 - the same
    return [value for value in names.values() if isinstance(value, names["test_case"])]


@pytest.mark.parametrize("exercise", list_exercise_ids())
def test_the_cases_have_the_points_of_the_exercise(exercise: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found = cases(exercise, monkeypatch)
    assert sum(case.points for case in found) == load_exercise(exercise).points
    assert len({case.name for case in found}) == len(found) > 1


def test_nothing_handed_in_fails_every_case_and_says_so(kernel: Kernel) -> None:
    points, failed, gradings = outcome(kernel, QUICK)
    assert (points, gradings) == (0, 0)
    assert set(failed.values()) == {f"Nothing was handed in: no cell that begins with %%submission {QUICK} was run."}


def test_the_cases_that_pass_are_the_partial_credit_of_one_grading(kernel: Kernel) -> None:
    kernel.run(f"%%submission {EXERCISE}\n{PARTIAL.read_text()}")
    points, failed, gradings = outcome(kernel, EXERCISE)
    report = grading.grade(EXERCISE, PARTIAL, seed=1)
    assert 0 < points == report.score < report.max_score
    assert gradings == 1
    assert list(failed) == [check.title for check in report.checks if check.status != "passed"]
    assert "success=False and a message that says why" in failed["NaN and infinity are refused with a reason"]


def test_under_otter_the_cells_of_a_submission_are_joined(kernel: Kernel) -> None:
    cells = [f"%%submission {QUICK}\nanswers = {{}}", f"%%submission {QUICK}\nnonsense ="]
    for cell in cells:
        kernel.run(cell)
    assert "nonsense" in str(outcome(kernel, QUICK)[1])
    kernel.run("sys.modules['otter'] = types.SimpleNamespace(Notebook=types.SimpleNamespace(_grading_mode=True))")
    try:
        for cell in reversed(cells):  # without being joined the last one alone would count, and it is no nonsense
            kernel.run(cell)
        assert "nonsense" in str(outcome(kernel, QUICK)[1])
    finally:
        kernel.run("del sys.modules['otter']")


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (f"check('{QUICK}', 'answer', seed=1)", "There is no check 'answer' in pattern_choice. Its checks: answers, "),
        ("check('pattern_choise', 'answers')", "Did you mean pattern_choice?"),
    ],
    ids=["check", "exercise"],
)
def test_what_an_instructor_misspells_is_named(kernel: Kernel, call: str, sentence: str) -> None:
    kernel.run(f"%%submission {QUICK}\nanswers = {{}}")
    done = kernel.run(f"from course_kit.otter import check\n{call}")
    assert "GradingError" in done.error
    assert sentence in done.error


def report(status: str, problem: str = "", checks: tuple[CheckReport, ...] = ()) -> Report:
    return Report(EXERCISE, "Title", "notebook.ipynb", status, False, 0.0, 10.0, 1.0, checks, problem=problem)


def test_a_submission_that_cannot_be_read_gets_the_reason() -> None:
    assert feedback(report("unreadable", "It is empty."), "offered") == "It is empty."


def test_the_command_prints_the_file_and_knows_its_seed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.main(["otter", QUICK, "--seed", "7"]) == 0
    assert capsys.readouterr().out == otter.case_file(QUICK, 7) != otter.case_file(QUICK)
    assert main.main(["otter", "pattern_choise"]) == 2
    assert "Did you mean pattern_choice?" in capsys.readouterr().err

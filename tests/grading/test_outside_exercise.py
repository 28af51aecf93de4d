"""An exercise of an instructor's folder is graded as the course's own are."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from course_kit import grading
from course_kit.grading.engine import GradingRequest
from course_kit.grading.model import catalogue
from course_kit.grading.model.exercise import load_exercise, read_exercise
from course_kit.grading.pool import Pool
from course_kit.grading.reading import Reader, copy_file
from tests import outside_exercises
from tests.outside_exercises import ID

if TYPE_CHECKING:
    from pathlib import Path


def grade(made: Path, program: Path, worker: grading.Worker) -> grading.Report:
    return grading.grade(ID, program, worker=worker, exercises=made.parent)


def _rename_a_field(made: Path) -> None:
    for name in ("interfaces/three_interfaces/srv/Three.srv", "checks.py", "solution/add_three.py"):
        (made / name).write_text((made / name).read_text().replace("sum", "total"))


def test_its_solution_and_its_starter_get_their_points(tmp_path: Path, worker: grading.Worker) -> None:
    made = outside_exercises.write(tmp_path)
    right = grade(made, made / "solution" / "add_three.py", worker)
    assert (right.score, right.max_score, right.passed) == (3.0, 3.0, True), right.problem
    starter = grade(made, made / "add_three.py", worker)
    assert (starter.score, starter.passed) == (1.0, False)
    assert starter.checks[1].hint == "A sum has three parts here."


def test_the_authors_hints_come_before_the_kits(tmp_path: Path) -> None:
    """In the course's own exercises that of a diagnosis comes first: there it is more to the point."""
    mine = read_exercise(outside_exercises.write(tmp_path))
    own = load_exercise("temperature_service")
    known = catalogue.catalogue()["service.blocks"]
    assert mine.hints_for("adds", known) == ("A sum has three parts here.", known.hint)
    assert own.hints_for("fifty_calls", known) == (known.hint, *own.ladder("fifty_calls"))
    formula = own.hints_for("same_unit", catalogue.catalogue()["math.formula"])
    assert "21.5 C" in formula[0]
    assert not any("212 F" in hint for hint in formula)  # which is about the other checks
    undeclared, own = catalogue.catalogue()["parameter.undeclared"], load_exercise("robot_parameters")
    assert "allow_undeclared_parameters" in own.hints_for("undeclared", undeclared)[0]  # the check's own cause
    assert "declare_parameter" in own.hints_for("declared", undeclared)[0]
    with (mine.folder / "exercise.toml").open("a") as file:
        file.write('\n[[hints]]\nfor = ["service.blocks"]\ntext = "Who waits?"\n')
    mine = read_exercise(mine.folder)
    assert mine.hints_for("adds", known) == ("Who waits?", "A sum has three parts here.")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ("CHECKS = [there, adds]", "CHECKS = tuple([there])"),
            "the checks are worth 1 point together, but the exercise 3",
        ),
        (("CHECKS = [there, adds]", "CHECKS = [there, add]"), "checks.py, line 14, cannot be run: NameError"),
        (("CHECKS = [there, adds]", "CHECKS = ["), "checks.py, line 14, cannot be run: SyntaxError"),
        (("CHECKS = [there, adds]", ""), "has neither CHECKS, a list of checks, nor checks_for"),
        (("points=2.0", "points=1.5"), "the checks are worth 2.5 points together, but the exercise 3"),
        (("from .samples", "from .sample"), "cannot be run: ModuleNotFoundError"),
    ],
)
def test_a_mistake_in_its_checks_is_no_zero_and_is_said(
    change: tuple[str, str], said: str, tmp_path: Path, worker: grading.Worker
) -> None:
    made = outside_exercises.write(tmp_path)
    checks = made / "checks.py"
    assert change[0] in checks.read_text()
    checks.write_text(checks.read_text().replace(*change))
    report = grade(made, made / "solution" / "add_three.py", worker)
    assert report.status == "error"
    assert said in report.problem


def test_workers_that_begin_with_both_keep_them_apart(tmp_path: Path) -> None:
    """As in a class: what exercises need is loaded once, before the first submission."""
    one = outside_exercises.write(tmp_path / "one")
    other = outside_exercises.write(tmp_path / "other")
    _rename_a_field(other)
    with closing(Pool(1)) as pool, Reader() as reader:
        for made in (other, one):
            exercise = read_exercise(made)
            with copy_file(exercise.solution) as copy:
                report = pool.grade(GradingRequest(exercise, reader.read(copy, exercise), "it", 1))
            assert report.score == 3.0, (made, report.problem)

"""`--seeds` and `course-kit seeds`: everybody has a seed of their own, and all mistakes of a list are told at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.records import Entry
from course_kit.classroom.rules import seeds
from course_kit.classroom.rules.people import People
from course_kit.cli.main import main
from course_kit.grading import GradingError
from tests.classroom.stand_ins import StandInForGrading, run

if TYPE_CHECKING:
    from pathlib import Path


def listed(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "seeds.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_doubles_and_what_is_no_seed_are_told_together_with_their_lines(tmp_path: Path) -> None:
    path = listed(tmp_path, "student,seed\nann,1\nbo,x\nann,2\n,4\ncy,-1\ndi,99999999999\n")
    with pytest.raises(GradingError) as told:
        seeds.read_seeds(path)
    for said in (
        "line 3: the seed 'x' is not a whole number",
        "line 4: ann stands in line 2 already",
        "line 5: the student is missing",
        "line 6: the seed '-1'",
        "line 7: the seed '99999999999'",
    ):
        assert said in str(told.value)


def test_absent_and_unknown_students_are_told_together_before_anything_is_graded(tmp_path: Path) -> None:
    for student in ("ann", "bo", "cy"):
        (tmp_path / "in" / student).mkdir(parents=True)
        (tmp_path / "in" / student / "temperature_service.py").write_text("right = 1")
    executor = StandInForGrading()
    found = seeds.read_seeds(listed(tmp_path, "student,seed\nann,1\nboo,2\n"))
    with pytest.raises(GradingError) as told:
        run(tmp_path / "in", tmp_path / "out", executor, seeds=found)
    assert "line 3: there is no student 'boo' here. Did you mean bo?" in str(told.value)
    assert "there is no seed for: bo, cy" in str(told.value)
    assert executor.requests == []
    assert not (tmp_path / "out/students").exists()


def test_the_command_writes_a_list_that_class_takes_and_keeps_seeds_that_were_handed_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    roster, out = tmp_path / "roster.csv", tmp_path / "seeds.csv"
    roster.write_text('login,name\nann,Ann Li\nzoe,"Zoë, the second"\n', encoding="utf-8")
    assert main(["seeds", str(roster), "--out", str(out)]) == 0
    before = seeds.read_seeds(out)
    assert set(before.said) == {("ann", ""), ("zoe", "")}
    roster.write_text('name,login\nAnn Li,ann\nBo Li,bo\n"Zoë, the second",zoe\n', encoding="utf-8")
    assert main(["seeds", str(roster), "--out", str(out)]) == 0
    after = seeds.read_seeds(out)
    assert [after.find(student) for student in ("ann", "zoe")] == [before.find(student) for student in ("ann", "zoe")]
    assert len({seed for seed, _ in after.said.values()}) == 3
    assert main(["seeds", str(roster)]) == 0
    assert capsys.readouterr().out.splitlines()[0] == "student,seed"


def test_a_student_is_found_by_any_of_their_names(tmp_path: Path) -> None:
    entry = Entry("4711", "pattern_choice", "x.py", "Ann Li", platform={"login": "ann"})
    absent = Entry("bo", "", "", "Bo Li")  # who is on the roster, and has handed in nothing
    for name in ("4711", "Ann Li", "ANN"):
        listed_seeds = seeds.read_seeds(listed(tmp_path, f"student,seed\n{name},5\nbo,6\n"))
        assert seeds.match_class(listed_seeds, [entry], People([entry, absent])).find("4711") == 5
        with pytest.raises(GradingError, match="line 3: there is no student 'bo' here"):
            seeds.match_class(listed_seeds, [entry], People([entry]))

"""What a class run does with submissions and results; the gradings themselves are stood in for."""

from __future__ import annotations

import json
from concurrent.futures import Future
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.intake import roster
from course_kit.classroom.records import Entry, GradeRecord, RecordFolder, safe_name
from course_kit.classroom.rules.people import Mistakes
from course_kit.classroom.rules.seeds import Seeds
from course_kit.grading import GradingError
from tests.classroom.stand_ins import CHOICE, SERVICE, StandInForGrading, results, run

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.engine import GradingRequest
    from course_kit.grading.model.report import Report


@pytest.fixture
def handed_in(tmp_path: Path) -> Path:
    files = {"ada": "right = 1", "bob": "wrong = 1", "cem": "right = 1", "dee": "", "eve": "right = 2"}
    for student, text in files.items():
        (tmp_path / "in" / student).mkdir(parents=True)
        (tmp_path / "in" / student / "temperature_service.py").write_text(text)
    return tmp_path / "in"


def test_who_is_absent_is_in_the_grades_by_name(handed_in: Path, tmp_path: Path) -> None:
    (tmp_path / "list.csv").write_text("login,name\nada,Ada L\nned,Ned N\n")
    book = run(handed_in, tmp_path / "out", StandInForGrading(), roster=roster.read_roster(tmp_path / "list.csv"))
    table = dict(exports.export_files(book))
    assert "ned,Ned N,,10,missing" in table["grades.csv"]
    assert "ada,Ada L,10,10,passed" in table["grades.csv"]
    assert (tmp_path / "out/intake.csv").is_file()


def test_everybody_gets_a_result_and_identical_submissions_are_graded_once(handed_in: Path, tmp_path: Path) -> None:
    executor = StandInForGrading()
    book = run(handed_in, tmp_path / "out", executor)
    assert results(book) == {
        "ada": ("graded", 10.0, ""),
        "bob": ("graded", 0.0, ""),
        "cem": ("graded", 10.0, "ada"),
        "dee": ("unreadable", 0.0, ""),
        "eve": ("graded", 10.0, ""),
    }
    assert [request.shown.partition("/")[0] for request in executor.requests] == ["ada", "bob", "eve"]
    assert executor.closed
    assert book.complete
    assert dict(book.tally()) == {"passed": 3, "not passed": 1, "unreadable": 1}


def test_what_may_last_is_begun_first(handed_in: Path, tmp_path: Path) -> None:
    (handed_in / "bob/temperature_service.py").write_text("import time\ntime.sleep(9)\nright = 5")
    (handed_in / "dee/temperature_service.py").write_text('"""Runs for a while\nuntil it ends."""\nright = 4')
    (handed_in / "eve/temperature_service.py").write_text("wrong = 2\nif wrong:\n    while True:\n        pass")
    executor = StandInForGrading()
    run(handed_in, tmp_path / "out", executor)
    assert [request.shown.partition("/")[0] for request in executor.requests] == ["bob", "eve", "ada", "dee"]


class NamingTheFile(StandInForGrading):
    """Says what went wrong as the grader does: with the file's name, and the traceback of the program."""

    def submit(self, request: GradingRequest) -> Future[Report]:
        report = super().submit(request).result()
        checks = tuple(replace(one, message=f"{request.text.name} ends.", told="It ends.") for one in report.checks)
        done: Future[Report] = Future()
        done.set_result(replace(report, checks=checks, stderr=f'  File "{request.text.program}", line 1, in main'))
        return done


def test_a_report_names_the_file_of_its_student_where_an_identical_one_was_graded(tmp_path: Path) -> None:
    for student in ("ada", "bob"):
        (tmp_path / "in" / student).mkdir(parents=True)
        (tmp_path / "in" / student / f"of_{student}.py.txt").write_text("wrong = 1")
    executor = NamingTheFile()
    run(tmp_path / "in", tmp_path / "out", executor)
    assert len(executor.requests) == 1
    for student, other in (("ada", "bob"), ("bob", "ada")):
        folder = tmp_path / "out/students" / student
        record = json.loads((folder / "temperature_service.json").read_text())
        assert record["report"]["submission"] == f"{student}/of_{student}.py.txt"
        assert record["report"]["checks"][0]["message"] == f"of_{student}.py.txt ends."
        assert record["report"]["stderr"] == f'  File "of_{student}.py", line 1, in main'
        page = (folder / "temperature_service.html").read_text()
        assert f"of_{student}.py" in page
        assert f"of_{other}" not in page


@pytest.mark.parametrize("score", ['"ten"', "half a fi"])
def test_a_record_that_cannot_be_read_is_none(score: str, handed_in: Path, tmp_path: Path) -> None:
    """Somebody wrote it by hand, or not to its end: its submission is graded again."""
    out = tmp_path / "out"
    first = run(handed_in, out, StandInForGrading())
    path = out / "students/ada/temperature_service.json"
    text = path.read_text()
    assert '"score": 10.0' in text
    path.write_text(text.replace('"score": 10.0', f'"score": {score}'))
    again = StandInForGrading()
    second = run(handed_in, out, again, resume=True)
    assert [request.shown.partition("/")[0] for request in again.requests] == ["ada"]
    assert results(second) == results(first)


def test_results_of_an_earlier_run_are_not_mixed_with_new_ones_by_accident(handed_in: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    seed = run(handed_in, out, StandInForGrading(), seed=7).seed
    assert seed == 7
    with pytest.raises(GradingError, match="--resume"):
        run(handed_in, out, StandInForGrading())
    with pytest.raises(GradingError, match="seed 7"):
        run(handed_in, out, StandInForGrading(), resume=True, seed=8)


def test_checks_draw_from_the_seed_of_the_run_the_exercise_or_the_student(handed_in: Path, tmp_path: Path) -> None:
    (handed_in / "ada/pattern_choice.py").write_text("answers = {}")
    (handed_in / "bob/pattern_choice.py").write_text("answers = {}")
    listed = {"ada": 98, "bob": 99, "cem": 1, "dee": 2, "eve": 3}
    said = {(student, ""): (seed, 1) for student, seed in listed.items()}
    seeds = Seeds(Mistakes(tmp_path / "seeds.csv"), said)
    own = StandInForGrading()
    run(handed_in, tmp_path / "own", own, exercises=(SERVICE, CHOICE), seed=7, seeds=seeds)
    executor = StandInForGrading()
    run(handed_in, tmp_path / "out", executor, exercises=(SERVICE, CHOICE), seed=7)
    usual = {(request.shown, request.seed) for request in executor.requests}
    assert ("ada/temperature_service.py", 7) in usual
    assert ("ada/pattern_choice.py", CHOICE.seed) in usual
    drawn = {(request.shown, request.seed) for request in own.requests}
    assert ("ada/pattern_choice.py", 98) in drawn
    assert ("bob/pattern_choice.py", 99) in drawn  # the same bytes as ada's, and not the same questions


def test_a_record_survives_its_file(tmp_path: Path) -> None:
    entry = Entry('="Zoë", 😀', "temperature_service", "x/y.py", "Zoë; DROP", late=True, platform={"login": "zoë"})
    record = GradeRecord(entry, "d" * 64, 3, 5, {"score": 1.0, "max_score": 2.0, "status": "graded", "checks": []})
    records = RecordFolder(tmp_path)
    records.keep(record)
    assert records.find(entry) == record
    assert list(records) == [record]
    with pytest.raises(ValueError, match="of this version"):
        GradeRecord.from_json(json.dumps({**json.loads(record.to_json()), "format_version": 99}))


@pytest.mark.parametrize(
    "names",
    [
        ("a/b", "a_b"),
        ("..", "_"),
        ("a" * 300, "a" * 301),
        ("あ" * 85, "あ" * 84),  # 255 bytes, the longest name that a folder can have
        ("a b", safe_name("a b")),  # whoever is called like somebody else's folder
    ],
)
def test_two_students_never_share_a_folder(names: tuple[str, str]) -> None:
    first, second = (safe_name(name) for name in names)
    assert first.lower() != second.lower()
    assert "/" not in first
    assert max(len(first.encode()), len(second.encode())) < 200, "with an ending and a mark it has to fit"


@pytest.mark.parametrize(("source", "out"), [("in", "in"), ("all/in", "all"), ("all/in", "link")])
def test_results_and_submissions_never_lie_in_one_another(tmp_path: Path, source: str, out: str) -> None:
    for name in ("in/ann", "all/in/ann"):
        (tmp_path / name).mkdir(parents=True)
        (tmp_path / name / "temperature_service.py").write_text("right = 1")
    (tmp_path / "link").symlink_to("all/in")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(GradingError, match="Name another folder with --out"):
        run(tmp_path / source, tmp_path / out, StandInForGrading())
    assert sorted(tmp_path.rglob("*")) == before


def test_a_grading_that_fails_is_an_error_for_its_student_and_graded_again(handed_in: Path, tmp_path: Path) -> None:
    class StandInForALostMachine(StandInForGrading):
        def submit(self, request: GradingRequest) -> Future[Report]:
            if not request.shown.startswith("ada"):
                return super().submit(request)
            lost: Future[Report] = Future()
            lost.set_exception(KeyError("timings"))
            return lost

    book = run(handed_in, tmp_path / "out", StandInForALostMachine())
    assert {name: result[0] for name, result in results(book).items() if result[0] == "error"} == {
        "ada": "error",
        "cem": "error",
    }
    assert book.complete
    assert [record.entry.student for record in book.not_graded] == ["ada", "cem"]
    again = StandInForGrading()
    assert results(run(handed_in, tmp_path / "out", again, resume=True))["ada"] == ("graded", 10.0, "")
    assert len(again.requests) == 1

"""Exercise 4 through the whole grader; right answers in many styles, and what each mistake is called: tests/proof."""

from __future__ import annotations

import ast
import json
from typing import TYPE_CHECKING, Any

import pytest

from course_kit import grading, quiz
from course_kit.reader.python import read_literal
from tests.course_copy import copy_course
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from tests.course_copy import Course

EXERCISE = "pattern_choice"
SOLUTION = ROOT / "solutions" / EXERCISE / f"{EXERCISE}.py"


@pytest.fixture
def grade(worker: grading.Worker, tmp_path: Path) -> Callable[..., grading.Report]:
    def run(source: str | bytes, name: str = "answer.py", **options: Any) -> grading.Report:
        path = tmp_path / name
        path.write_bytes(source if isinstance(source, bytes) else source.encode())
        return grading.grade(EXERCISE, path, worker=worker, **options)

    return run


@pytest.fixture
def answers() -> dict[str, tuple[str, str]]:
    found = {}
    for scenario in quiz.draw():
        pattern = next(iter(scenario.accepted))
        found[scenario.id] = (pattern, scenario.accepted[pattern][0])
    return found


def failed(report: grading.Report) -> list[grading.CheckReport]:
    return [check for check in report.checks if check.status != "passed"]


@pytest.mark.parametrize("seed", [2, 90210])
def test_solution_gets_full_marks_for_every_seed(seed: int, worker: grading.Worker) -> None:
    report = grading.grade(EXERCISE, SOLUTION, seed=seed, worker=worker)
    assert failed(report) == []
    assert {check.id.rpartition("_")[0] for check in report.checks[2:]} == {made.id for made in quiz.draw(seed)}


def test_each_half_has_a_check_that_can_fail(
    grade: Callable[..., grading.Report], answers: dict[str, tuple[str, str]]
) -> None:
    """Each answer in turn is made wrong: first the pattern alone, then the reason alone."""
    for place, half in ((0, "pattern"), (1, "reason")):
        wrong: dict[str, list[str]] = {}
        for scenario in quiz.draw():
            choices = [choice for choice in scenario.wrong if (choice in quiz.PATTERNS) == (half == "pattern")]
            wrong[scenario.id] = list(answers[scenario.id])
            wrong[scenario.id][place] = choices[0]
        report = grade(f"answers = {wrong!r}")
        assert report.score == 5.0
        assert {check.id for check in failed(report)} == {f"{name}_{half}" for name in answers}
        for check in failed(report):
            assert check.diagnosis is None
            assert (
                check.message
                == quiz.bank()[check.id.removesuffix(f"_{half}")].wrong[wrong[check.id[: -len(half) - 1]][place]]
            )
            assert check.hint


def test_no_report_of_a_wrong_answer_tells_the_right_one(
    grade: Callable[..., grading.Report], answers: dict[str, tuple[str, str]]
) -> None:
    report = grade("answers = {}")
    shown = " ".join(f"{check.got} {check.message} {check.hint}" for check in report.checks)
    assert not any(reason in shown for _, reason in answers.values())


def test_eight_points_pass_and_less_does_not(
    grade: Callable[..., grading.Report], answers: dict[str, tuple[str, str]]
) -> None:
    names = list(answers)
    kept = {name: answers[name] for name in names[:8]}
    assert grade(f"answers = {kept!r}").passed
    kept[names[0]] = (answers[names[0]][0], "")
    report = grade(f"answers = {kept!r}")
    assert (report.score, report.passed, grading.exit_code(report)) == (7.5, False, 1)


def test_far_too_many_answers(grade: Callable[..., grading.Report]) -> None:
    first = failed(grade("answers = {number: 'topic' * 9 for number in range(100_000)}"))[0]
    assert first.diagnosis == "quiz.malformed"
    assert "too large" in first.message


def test_deep_nesting_harms_nobody(grade: Callable[..., grading.Report]) -> None:
    report = grade("answers = {'weld_seam': " + "(" * 150 + "'action'," + ")" * 150 + "}")
    assert report.status == "graded"
    assert "quiz.malformed" in {check.diagnosis for check in failed(report)}


def test_a_program_that_only_waits_is_ended(
    grade: Callable[..., grading.Report], answers: dict[str, tuple[str, str]], tmp_path: Path
) -> None:
    """At the limit of wall time: it uses no processor, so that no other limit would end it."""
    folder = tmp_path / "exercises" / EXERCISE
    folder.mkdir(parents=True)
    text = (ROOT / "exercises" / EXERCISE / "exercise.toml").read_text()
    (folder / "exercise.toml").write_text(text.replace("wall_s = 20.0", "wall_s = 1.5"))
    program = f"import time\nanswers = {{}}\ntime.sleep(1000)\nanswers.update({answers!r})"
    report = grade(program, exercises=folder.parent)
    assert {check.diagnosis for check in failed(report) if check.status == "failed"} == {"limit.time"}
    assert "1.5 s in all" in failed(report)[0].message


def test_a_literal_is_read_and_never_run(
    grade: Callable[..., grading.Report], answers: dict[str, tuple[str, str]], tmp_path: Path
) -> None:
    report = grade(f"answers = {answers!r}\nprint('was run')\nopen({str(tmp_path / 'trace')!r}, 'w')")
    assert report.score == 10.0
    assert report.stdout == ""


def test_a_program_cannot_look_the_answers_up(grade: Callable[..., grading.Report], worker: grading.Worker) -> None:
    """Where its files are walled off: the bank is hidden from it, as the solutions are."""
    program = """
from course_kit import quiz
answers = {}
for name, scenario in quiz.bank().items():
    pattern = next(iter(scenario.accepted))
    answers[name] = pattern, scenario.accepted[pattern][0]
"""
    walled = worker.ready().files
    assert grade(program).score == (0.0 if walled else 10.0)


def test_forged_notes_are_no_more_than_answers(grade: Callable[..., grading.Report]) -> None:
    program = """
import os
for note in (b'{"note": {"set_names": 3, "entries": 7}}', b'{"note": {"set_names": [], "entries": [1]}}'):
    for number in range(200, 256):
        try:
            os.write(number, b"\\n" + note + b"\\n")
        except OSError:
            pass
answers = {}
del answers
os._exit(0)
"""
    report = grade(program)
    assert report.score == 0.0
    assert not any(check.status == "error" for check in report.checks)


@pytest.fixture(scope="module")
def students(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """A course without the answers, as students have it."""
    course = copy_course(tmp_path_factory.mktemp("students"))
    (course.root / "course_kit" / "quiz" / "data" / "answers.toml").unlink()
    return course


def test_without_the_answers_the_practice_questions_are_marked(students: Course) -> None:
    done = students.run("grade", EXERCISE, str(SOLUTION), "--format", "json")
    assert (json.loads(done.stdout)["score"], done.returncode) == (10.0, 0)


def test_without_the_answers_no_other_seed_is_marked_and_what_is_missing_is_said(
    students: Course, tmp_path: Path
) -> None:
    drawn = quiz.draw(7)
    pairs = {scenario.id: ("topic", next(iter(scenario.reasons))) for scenario in drawn}
    pairs[drawn[0].id] = ("topic", "")
    mine = tmp_path / "mine.py"
    mine.write_text(f"answers = {pairs!r}", encoding="utf-8")
    done = students.run("grade", EXERCISE, str(mine), "--seed", "7", "--format", "json")
    report = json.loads(done.stdout)
    assert (report["status"], report["score"], done.returncode) == ("error", 0.0, 2)
    assert "your instructor marks the scenarios of this seed" in report["stderr"]
    assert f"9 of 10 answers are complete. Still to do: {drawn[0].id} (The reason is still empty)." in report["stderr"]


@pytest.mark.parametrize(
    "made",
    ["class Answer(tuple):\n    pass", "def Answer(pattern, reason):\n    return pattern, reason", "Answer = tuple"],
)
def test_a_name_that_the_program_defines_is_no_text_without_quotes(made: str) -> None:
    """What such a value is shows only when the program runs."""
    assert read_literal(ast.parse(f"{made}\nanswers = {{'weld_seam': Answer('topic', 'late')}}"), "answers") is None
    undefined = read_literal(ast.parse("answers = {'weld_seam': Answer}"), "answers")
    assert undefined == {
        "entries": [
            (
                "'weld_seam'",
                "Answer",
                "Without quotes, Python reads Answer as the name of a variable, and there is no such variable.",
            )
        ]
    }

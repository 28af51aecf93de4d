"""`course-kit dev check` on a small course of our own: what is proven, and what is named when something is not."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.authoring import corpus, rules
from course_kit.cli import main
from course_kit.grading import CheckReport, Report
from course_kit.grading.model.catalogue import catalogue, complete_message

EXERCISE = "pattern_choice"  # nothing has to be run for it: answers that are written out are read
ROOT = environment.checkout_folder() or Path()
BROKEN = ("quiz.malformed", "quiz.unknown", "start.syntax")


@pytest.fixture
def course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with one exercise, three broken submissions and as many right ones as are wanted."""
    shutil.copytree(ROOT / "exercises" / EXERCISE, tmp_path / "exercises" / EXERCISE)
    settings = tmp_path / "exercises" / EXERCISE / "exercise.toml"
    before, _, after = settings.read_text().partition("[[sentences]]")
    settings.write_text(before + after[after.index("[[hints]]") :])  # proving each takes more submissions than these
    shutil.copytree(ROOT / "solutions" / EXERCISE, tmp_path / "solutions" / EXERCISE)
    broken = tmp_path / "tests" / "broken" / EXERCISE
    broken.mkdir(parents=True)
    for name in BROKEN:
        shutil.copy(ROOT / "tests" / "broken" / EXERCISE / f"{name}.py", broken)
    variants = tmp_path / "tests" / "grading" / "correct" / EXERCISE
    variants.mkdir(parents=True)
    for number in range(8):
        shutil.copy(solution(tmp_path), variants / f"copy_{number}.py")
    for name in ("checkout_folder", "course_files"):
        monkeypatch.setattr(environment, name, lambda: tmp_path)
    return tmp_path


def solution(course: Path) -> Path:
    return course / "solutions" / EXERCISE / f"{EXERCISE}.py"


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str, str]:
    code = main.main(["dev", "check", "--workers", "2", *arguments])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def test_a_course_that_is_right_is_proven(course: Path, capsys: pytest.CaptureFixture[str]) -> None:
    del course
    code, out, err = run(capsys, EXERCISE, "--seed", "5")
    assert code == 0
    assert [line.split() for line in out.splitlines()[:2]] == [
        ["exercise", "starter", "solution", "variants", "broken", "slips", "checks", "sentences"],
        [EXERCISE, "2", "1", "8", "3", "-", "22", "-"],
    ]
    assert "PROVEN. 14 submissions graded in" in out
    assert "[14/14] pattern_choice" in err
    assert max(map(len, out.splitlines())) <= 120


def test_a_wrong_solution_is_named(course: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = solution(course).read_text()
    solution(course).write_text(text.replace("answers = {", "answers = {}\nothers = {"))
    code, out, _ = run(capsys, EXERCISE)
    assert code == 1
    assert "pattern_choice solution pattern_choice.py: it should get full marks" in " ".join(out.split())
    assert "NOT PROVEN" in out


def test_a_code_without_submission_is_named(course: Path, capsys: pytest.CaptureFixture[str]) -> None:
    del course
    code, out, _ = run(capsys)
    said = " ".join(out.split())
    assert code == 1
    named = set(re.findall(r"✗ ([\w.]+): no broken program and no slip is named after it", said))
    assert named == set(catalogue()) - set(BROKEN)
    assert f"NOT PROVEN: {len(named)} faults." in said


def test_a_slip_is_judged_by_what_it_says(course: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = course / "tests" / "slips" / f"{EXERCISE}.toml"
    path.parent.mkdir()
    text = """
[{name}]
says = '{says}'
failed = {{ answers = "quiz.missing" }}
[[{name}.changes]]
old = 'answers = {{'
new = 'answer = {{'
"""
    path.write_text(text.format(name="right", says="Did you mean answer") + text.format(name="odd", says="unicorn"))
    code, out, _ = run(capsys, EXERCISE)
    assert code == 1
    assert "pattern_choice slip odd: a message should say 'unicorn'" in " ".join(out.split())
    path.write_text(text.format(name="odd", says="").replace("answers = {'", "no such text'"))
    code, out, err = run(capsys, EXERCISE)
    assert (code, out) == (2, "")
    told = (
        f"tests/slips/{EXERCISE}.toml: the slip odd replaces a text that occurs 0 times in {solution(course)}, not once"
    )
    assert told in err
    path.write_text(path.read_text().replace("failed", "fails"))
    assert f"{path} cannot be used: in the slip odd, there is no setting 'fails'." in run(capsys, EXERCISE)[2]


def made_report(submission: corpus.ProofSubmission, **failed: str | None) -> Report:
    """A report in which the checks named have failed, each with its diagnosis, and `fine` has passed."""
    checks = [CheckReport("fine", "Fine", "passed", 1.0, points=1.0)]
    for name, code in failed.items():
        known = catalogue().get(code or "")
        message = complete_message("It failed.", known)
        checks.append(CheckReport(name, name, "failed", 1.0, "", "a", "b", code, message, hint="a hint", known=known))
    score = float(not failed)
    return Report(submission.exercise, "", "", "graded", not failed, score, 1.0, 0.1, tuple(checks))


def made_sets(*submissions: corpus.ProofSubmission) -> corpus.Corpus:
    loaded = corpus.load_corpus("temperature_service", ROOT)
    return corpus.Corpus(loaded.exercise, submissions)


def texts(rule: str, of: corpus.Corpus, reports: dict[corpus.ProofSubmission, Report]) -> str:
    return "\n".join(str(fault) for fault in rules.find_faults(of, reports) if fault.rule == rule)


def test_a_check_that_nothing_turns_red_is_named() -> None:
    right, wrong = (corpus.load_corpus("temperature_service", ROOT).of_kind(kind)[0] for kind in ("solution", "slip"))
    reports = {right: made_report(right), wrong: made_report(wrong, other=None)}
    said = texts("checks", made_sets(right, wrong), reports)
    assert said == "temperature_service: no submission makes the check 'fine' fail."


@pytest.mark.parametrize(
    ("failed", "said"),
    [
        ({"offered": "start.exit"}, "it should get this code alone, and gets:"),
        ({"offered": "start.crash", "answers": None}, "it should get this code alone, and gets:"),
        ({}, "it should get this code alone, and gets:"),
        ({"offered": "start.crash"}, ""),
    ],
)
def test_broken_submission_with_another_code_is_named(failed: dict[str, str | None], said: str) -> None:
    one = next(
        one for one in corpus.load_corpus("temperature_service", ROOT).of_kind("broken") if one.name == "start.crash"
    )
    found = texts("broken", made_sets(one), {one: made_report(one, **failed)})
    assert found.startswith(f"temperature_service broken start.crash: {said}" if said else "")
    assert bool(found) == bool(said)


def test_poor_feedback_is_named() -> None:
    one = next(
        one for one in corpus.load_corpus("temperature_service", ROOT).of_kind("broken") if one.name == "start.crash"
    )
    report = made_report(one, offered="start.crash")
    silent = replace(report.checks[1], hint=None, got="", message="?")
    found = texts("broken", made_sets(one), {one: replace(report, checks=(silent,))})
    assert "says nothing under 'hint'" in found
    assert "says nothing under 'got'" in found


def test_starter_that_passes_or_has_no_hint_of_its_own_is_named() -> None:
    program, notebook = corpus.load_corpus("temperature_service", ROOT).of_kind("starter")
    reports = {program: made_report(program), notebook: made_report(notebook, answers=None)}
    said = texts("starter", made_sets(program, notebook), reports)
    assert "starter temperature_service.py: it should be graded and not passed" in said
    assert "starter temperature_service.ipynb: its first failed check, answers, has no hint from the ladder" in said
    assert "different verdicts" in said

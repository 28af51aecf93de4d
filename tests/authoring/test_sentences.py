"""No sentence without a check, no check without a sentence; and what a proof run shows of them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec
import pytest

from course_kit import environment
from course_kit.authoring import corpus, rules
from course_kit.authoring.corpus import Corpus, ProofSubmission
from course_kit.grading import CheckReport, Report
from course_kit.grading.model.exercise import Sentence, load_exercise

if TYPE_CHECKING:
    from course_kit.grading.checks.check import Check

ROOT = environment.checkout_folder()
assert ROOT is not None
EXERCISES = corpus.all_exercises(ROOT)
EXERCISE = load_exercise("temperature_service")
CHECKS = rules.checks_of(EXERCISE)


@pytest.mark.parametrize("name", EXERCISES)
def test_sentences_and_checks_fit_together(name: str) -> None:
    exercise = load_exercise(name)
    assert rules.find_sentence_faults(exercise, rules.checks_of(exercise)) == []
    assert len(exercise.sentences) >= 10


@pytest.mark.parametrize("name", EXERCISES)
def test_freedoms_name_programs_that_are_there(name: str) -> None:
    sets = corpus.load_corpus(name, ROOT)
    right = {one.path.stem for one in sets.submissions if one.kind in ("solution", "variant")}
    right |= {one.name for one in sets.of_kind("slip") if not one.failed}
    assert {one.freedom for one in sets.exercise.sentences if one.freedom} <= right


def without(checks: tuple[Check, ...], name: str) -> list[Check]:
    return [replace(one, proves=tuple(each for each in one.proves if each != name)) for one in checks]


def test_sentence_without_a_check_is_named() -> None:
    assert rules.find_sentence_faults(EXERCISE, without(tuple(CHECKS), "same_unit")) == [
        "no sentence of the task says what the check 'same_unit' tests.",
        "no check tests the sentence 'same_unit'.",
    ]


BREAKS = ProofSubmission(
    EXERCISE.id, "slip", "breaks_it", EXERCISE.folder, failed=frozenset({("x", None)}), breaks=("node",)
)
RIGHT = ProofSubmission(EXERCISE.id, "variant", "right", EXERCISE.folder / "right.py")
NODE = Sentence("node", "the node is called so.", heading="Of course")
FREE = Sentence("free", "Any message will do.", freedom="right")
ALL = Corpus(msgspec.structs.replace(EXERCISE, sentences=(NODE, FREE)), (BREAKS, RIGHT))


def report(score: float, **statuses: str) -> Report:
    checks = tuple(
        CheckReport(id=name, title=name, status=status, points=0.0, max_points=1.0) for name, status in statuses.items()
    )
    return Report(
        EXERCISE.id, "", "", "graded", passed=False, score=score, max_score=1.0, duration_s=0.0, checks=checks
    )


def test_a_sentence_is_proven_by_what_breaks_it_and_turns_its_check_red() -> None:
    reports = {BREAKS: report(0.0, node_name="failed", answers="failed"), RIGHT: report(1.0, node_name="passed")}
    assert list(rules.find_unproven(ALL, reports)) == []


def test_freedom_that_costs_points_is_none() -> None:
    reports = {BREAKS: report(0.0, node_name="failed"), RIGHT: report(0.5)}
    assert list(rules.find_unproven(ALL, reports)) == [
        "the sentence 'free' grants a freedom, and there is no right program 'right' with full marks."
    ]


def test_submission_that_breaks_what_no_sentence_says_is_named() -> None:
    strange = replace(BREAKS, breaks=("node", "moon"))
    reports = {strange: report(0.0, node_name="failed"), RIGHT: report(1.0)}
    assert list(rules.find_unproven(replace(ALL, submissions=(strange, RIGHT)), reports)) == [
        "slip breaks_it breaks the sentence 'moon', which exercise.toml does not have."
    ]

"""The page of `course-kit prove`: what sees each line, in light and dark, without a request to another host."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from course_kit.authoring.prove import equivalent, mutants
from course_kit.authoring.prove.outcome import GraderProof, MutantOutcome, VariantOutcome
from course_kit.authoring.prove.page import render_proof
from course_kit.authoring.prove.verdicts import Verdict
from course_kit.grading import exercise
from course_kit.grading.report import CheckReport
from tests.browser.learner import ARTIFACTS, page

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


def proof() -> GraderProof:
    """A proof of the course's first exercise, with verdicts of our own: every kind of line is there."""
    task = exercise.load("temperature_service")
    source = task.solution.read_text()
    declared = equivalent.DeclaredEquivalent("main()", "call left out", "The class alone <will> do.")
    outcomes = []
    for number, one in enumerate(mutants.of(source)):
        seen = Verdict(full_marks=False, failed=("answers",))
        verdicts = () if number % 7 == 3 else (Verdict(full_marks=True) if one.before == "main()" else seen,)
        if one.line == 29:
            verdicts = (Verdict(full_marks=True),)
        outcomes.append(MutantOutcome(one, verdicts, declared if declared.covers(one) else None))
    rejected = VariantOutcome("asynchronous callbacks", (Verdict(full_marks=False, failed=("answers",)),))
    checks = (CheckReport("answers", "A request gets an answer", "passed", 1.0),)
    right = VariantOutcome("the solution", (Verdict(full_marks=True),))
    return GraderProof(task, task.solution, source, checks, tuple(outcomes), (right, rejected))


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_page_of_a_proof(tmp_path: Path, scheme: str) -> None:
    path = tmp_path / "proof.html"
    path.write_text(render_proof(proof()))
    with page() as opened:
        opened.emulate_media(color_scheme="dark" if scheme == "dark" else "light")
        asked: list[str] = []
        opened.on("request", lambda request: asked.append(request.url) if "file:" not in request.url else None)
        opened.goto(path.as_uri())
        expect(opened.get_by_role("heading", level=1)).to_contain_text("What the grader of")
        survivors = opened.locator("#line-29")
        expect(survivors).to_have_class("survived")
        expect(survivors).to_contain_text("Nobody sees: empty text")
        expect(opened.locator("#line-17")).to_have_class("seen")
        expect(opened.locator("#line-17 code").last).to_have_attribute("title", "A request gets an answer")
        opened.get_by_text("declared as equivalent").last.click()
        expect(opened.get_by_text("The class alone <will> do.")).to_be_visible()
        expect(opened.get_by_text("This grader rejects a right program: asynchronous callbacks")).to_be_visible()
        assert Axe().run(opened).violations_count == 0
        ARTIFACTS.mkdir(parents=True, exist_ok=True)
        opened.screenshot(path=ARTIFACTS / f"proof_page_{scheme}.png", full_page=True)
        assert asked == []

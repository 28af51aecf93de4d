"""The report: the contract's JSON to the letter, text for terminals, HTML that nobody can inject into."""

from __future__ import annotations

import json
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from course_kit.grading import CheckReport, Report, exit_code, render_html, render_text
from course_kit.grading.diagnosis import catalogue, complete

FAILED = CheckReport(
    "celsius_to_fahrenheit",
    "Celsius becomes Fahrenheit",
    "failed",
    0.0,
    2.0,
    "value=100.0",
    "212.0",
    "<script>alert(1)</script>" + "x" * 300,
    "math.formula",
    "The factor is upside down & more.",
    "Think.",
)
PASSED = CheckReport("offered", "The service is there", "passed", 1.5, 1.5, "", "e", "e")
SKIPPED = CheckReport("precision", "Every digit", "skipped", 0.0, 0.5, message="Not run.")
REPORT = Report(
    "temperature_service",
    "A service",
    "<b>me</b>.py",
    "graded",
    passed=False,
    score=1.5,
    max_score=4.0,
    duration_s=1.23456,
    checks=(PASSED, FAILED, SKIPPED),
    stdout="<i>out</i>",
    stderr="err",
    isolation="walls",
)
KEYS = [
    "format_version",
    "exercise",
    "submission",
    "status",
    "score",
    "max_score",
    "passed",
    "duration_s",
    "checks",
    "stdout",
    "stderr",
]
CHECK_KEYS = [
    "id",
    "title",
    "status",
    "points",
    "max_points",
    "sent",
    "expected",
    "got",
    "diagnosis",
    "message",
    "hint",
]


class Elements(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.opened: list[str] = []
        self.closed: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        del attrs
        self.opened.append(tag)

    def handle_endtag(self, tag: str) -> None:
        self.closed.append(tag)


def test_json_has_exactly_the_names_of_the_contract() -> None:
    data = json.loads(REPORT.to_json())
    assert list(data) == KEYS
    assert [list(check) for check in data["checks"]] == [CHECK_KEYS] * 3
    assert (data["format_version"], data["score"], data["max_score"], data["passed"]) == (1, 1.5, 4.0, False)
    assert data["checks"][0]["diagnosis"] is None
    assert data["checks"][1]["hint"] == "Think."


def test_json_of_a_sum_of_tenths_is_exact() -> None:
    assert json.loads(replace(REPORT, score=0.1 + 0.2).to_json())["score"] == 0.3


@pytest.mark.parametrize(
    ("status", "passed", "code"),
    [
        ("graded", True, 0),
        ("graded", False, 1),
        ("crashed", False, 1),
        ("unreadable", False, 2),
        ("error", False, 2),
    ],
)
def test_exit_codes(status: str, passed: bool, code: int) -> None:
    assert exit_code(replace(REPORT, status=status, passed=passed)) == code


@pytest.mark.parametrize("width", [60, 80, 120])
def test_text_fits_and_says_all(width: int) -> None:
    text = render_text(REPORT, width)
    assert max(len(line) for line in text.splitlines()) <= width
    for word in (
        "PASS",
        "FAIL",
        "skip",
        "we sent",
        "212.0",
        "math.formula",
        "upside down",
        "Think.",
        "1.5 of 4 points",
    ):
        assert word in text
    assert "\x1b" not in text


def test_text_of_what_could_not_be_graded() -> None:
    text = render_text(replace(REPORT, status="unreadable", checks=(), problem="It is empty."))
    assert "It is empty." in text
    assert "could not be read" in text


def test_html_escapes_everything_and_is_balanced() -> None:
    html = render_html(REPORT)
    assert "<script" not in html
    assert "<i>out" not in html
    assert "&lt;script&gt;" in html
    assert "upside down &amp; more" in html
    elements = Elements(html)
    assert sorted(elements.opened) == sorted(elements.closed)


def test_html_says_in_words_what_it_shows_in_colour() -> None:
    html = render_html(REPORT)
    for words in (": passed, 1.5 of 1.5", ": not passed, 0 of 2", ": not run, 0 of 0.5", "1.5 of 4 points"):
        assert words in html
    assert "<details><summary>Show a hint" in html


def test_html_of_what_could_not_be_graded() -> None:
    html = render_html(replace(REPORT, status="error", checks=(), problem="<broken>"))
    assert "&lt;broken&gt;" in html
    assert "Not graded" in html


def test_catalogue_has_all_for_each_code() -> None:
    for code, entry in catalogue().items():
        assert entry.title, code
        assert entry.explanation.endswith("."), code
        assert entry.hint.endswith((".", "?")), code
        assert entry.notebook.endswith(".ipynb"), code
        assert " " not in entry.link, code


def test_message_is_completed_with_why_and_where() -> None:
    text = complete("It happened.", "service.no_return")
    assert text.startswith("It happened. ")
    assert catalogue()["service.no_return"].explanation in text
    assert "notebooks/01_services.ipynb#" in text
    assert complete("It happened.", None) == "It happened."

"""The report as a page of its own: the program with the line of the failure marked, and no link that leads nowhere."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from course_kit.classroom.exports.report_page import LONGEST, MOST_LINES, mark_lines, render_page, with_notice
from course_kit.grading import CheckReport, Report
from course_kit.grading.model.catalogue import catalogue
from course_kit.grading.model.submission import Submission
from course_kit.grading.render.html import render_html

PROGRAM = Submission("answer.py", "answer.py", "import math\n\n\ndef f(x):\n    return 1 / x  # <here> & there\n")
FAILED = CheckReport(
    "a",
    "Zero is refused",
    "failed",
    5,
    message="Your callback raised ZeroDivisionError in line 5: return 1 / x. Read on.",
    told="Your callback raised ZeroDivisionError in line 5: return 1 / x.",
    diagnosis="service.no_return",
    known=catalogue()["service.no_return"],
)
PASSED = CheckReport("b", "It is there", "passed", 5, points=5, message="line 1")
REPORT = Report("temperature_service", "A service", "answer.py", "graded", False, 5, 10, 1.0, (FAILED, PASSED))


def marked(report: Report, submission: Submission) -> dict[int, tuple[str, ...]]:
    return {line.number: line.checks for line in mark_lines(report, submission) if line.checks}


def test_the_line_that_a_failed_check_speaks_of_is_marked_with_its_title() -> None:
    assert marked(REPORT, PROGRAM) == {5: ("Zero is refused",)}
    html = render_page(REPORT, "Jane Doe", PROGRAM)
    row = re.search(r'<tr id="line-5" class="marked">.*?</tr>', html, re.DOTALL)
    assert row is not None
    assert "# &lt;here&gt; &amp; there" in row[0]
    assert "← Zero is refused" in row[0]
    assert '<a href="#line-5">line 5</a>' in html
    assert html.count('class="marked"') == 1
    assert "<details open><summary>5 lines</summary>" in html


def test_a_program_that_is_long_is_cut() -> None:
    endless = replace(PROGRAM, source="x" * 5000 + "\n" + "pass\n" * 5000)
    found = mark_lines(REPORT, endless)
    assert (len(found), len(found[0].text)) == (MOST_LINES, LONGEST)
    assert "and more, which are not shown" in render_page(REPORT, "Jane", endless)


def test_no_link_of_a_page_leads_out_of_it() -> None:
    html = render_page(REPORT, "Jane Doe", PROGRAM)
    links = re.findall(r'href="([^"]*)"', html)
    assert links == ["#line-5"]
    assert "notebooks/01_services.ipynb" in html, "it is named instead"


def test_without_a_program_there_is_no_section_for_it_and_a_notebooks_card_never_has_one() -> None:
    assert "The program" not in render_page(REPORT, "Jane Doe")
    assert "The program" not in render_html(REPORT)


@pytest.mark.parametrize("page", ["", "<p>mine</p>", "<!-- notice --><p>mine</p>"])
def test_a_page_without_both_marks_of_a_notice_stays_as_it_is(page: str) -> None:
    assert with_notice(page, "1 of 2", ["Late."]) == page

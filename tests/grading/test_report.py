"""The report: JSON with exactly its names, text for terminals, HTML that nobody can inject into."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from course_kit import environment
from course_kit.grading import CheckReport, Report, exit_code, render_html, render_text
from course_kit.grading.checks.evidence import GRADER, NODE
from course_kit.grading.model.catalogue import catalogue, complete_message
from course_kit.grading.sandbox.output_collector import BoundedOutput
from course_kit.ros.sequence import Arrow
from course_kit.text.sanitize import make_printable

FAILED = CheckReport(
    "celsius_to_fahrenheit",
    "Celsius becomes Fahrenheit",
    "failed",
    2.0,
    "value=100.0",
    "212.0",
    "<script>alert(1)</script>" + "x" * 300,
    "math.formula",
    "The factor is upside down & more.",
    hint="Think.",
    told="The factor is upside down & more.",
    steps=(
        Arrow(GRADER, NODE, "request", "request /convert: value=100.0"),
        Arrow(NODE, GRADER, "response", "response: <script>alert(2)</script>"),
        Arrow(GRADER, NODE, "message", "/cmd_vel_in: " + "linear.x=1.0 " * 20),
        Arrow(NODE, GRADER, "failure", "no answer within 5 s"),
        Arrow(GRADER, GRADER, "note", "expected: 212.0"),
    ),
    more_hints=("Think <again>.", "Think at last."),
)
PASSED = CheckReport("offered", "The service is there", "passed", 1.5, "", "e", "e", points=1.5)
FREE = CheckReport("known_ids", "Every entry belongs", "passed", 0.0)
SKIPPED = CheckReport("precision", "Every digit", "skipped", 0.5, message='Not run, because "It adds" did not pass.')
ALSO_SKIPPED = replace(SKIPPED, id="edges", title="Each edge", max_points=1.5)
REPORT = Report(
    "temperature_service",
    "A service",
    "<b>me</b>.py",
    "graded",
    passed=False,
    score=1.5,
    max_score=4.0,
    duration_s=1.23456,
    checks=(PASSED, FREE, FAILED, SKIPPED),
    stdout="<i>out</i>",
    stderr="err",
    isolation="own network",
)
KEYS = [
    *("format_version", "exercise", "submission", "status", "score", "max_score", "passed"),
    *("duration_s", "checks", "stdout", "stderr"),
]
CHECK_KEYS = [
    *("id", "title", "status", "points", "max_points"),
    *("sent", "expected", "got", "diagnosis", "message", "hint"),
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


def test_json_has_exactly_these_names() -> None:
    data = json.loads(REPORT.to_json())
    assert list(data) == KEYS
    assert [list(check) for check in data["checks"]] == [CHECK_KEYS] * 4
    assert (data["format_version"], data["score"], data["max_score"], data["passed"]) == (1, 1.5, 4.0, False)
    assert data["checks"][0]["diagnosis"] is None
    assert data["checks"][2]["hint"] == "Think."


def test_json_can_be_written_whatever_a_submission_says() -> None:
    half = "\ud800 half a character"
    text = replace(REPORT, stdout=half, submission="\udcff.py").to_json()
    assert json.loads(text.encode())["stdout"] == half


@pytest.mark.parametrize(
    ("status", "passed", "code"),
    [("graded", True, 0), ("graded", False, 1), ("crashed", False, 1), ("unreadable", False, 2), ("error", False, 2)],
)
def test_exit_codes(status: str, passed: bool, code: int) -> None:
    assert exit_code(replace(REPORT, status=status, passed=passed)) == code


@pytest.mark.parametrize("width", [80, 120])
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
        "1. grader -> your node: request /convert",
        "4. your node -> grader, not as expected: no answer",
        "Isolation of your program: own network.",
    ):
        assert word in text
    assert "\x1b" not in text


def test_printed_lines_are_cut_at_spaces() -> None:
    text = render_text(replace(REPORT, stderr="    " + "reason " * 20), 80)
    assert "\n  |     reason reason" in text
    assert "reaso\n" not in text


def test_what_failed_comes_first_and_what_waits_for_one_check_is_one_line() -> None:
    report = replace(REPORT, checks=(PASSED, SKIPPED, FAILED, ALSO_SKIPPED))
    text, html = render_text(report, 200), render_html(report).rpartition("</style>")[2]
    waiting = ['skip      0/2  Not run, because "It adds" did not pass:', "- Every digit", "- Each edge"]
    assert f"\n{' ' * 15}".join(waiting) in text
    assert "Not run, because &#34;It adds&#34; did not pass (2)" in html
    ends = ("1.5 of 4 points", "Isolation of")
    order = ("FAIL", "upside down", "value=100.0", "Think.", "math.formula", "PASS", "skip", *ends)
    assert [text.index(one) for one in order] == sorted(text.index(one) for one in order)
    order = (FAILED.title, *order[1:5], PASSED.title, "Not run", "Isolation of")
    assert [html.index(one) for one in order] == sorted(html.index(one) for one in order)
    for page in (text, html):
        assert not [line for line in page.splitlines() if line.strip().startswith(":")]


def test_a_drill_is_solved_or_not_yet_and_nobody_speaks_of_points() -> None:
    drill = replace(REPORT, practice=True)
    for one, said in ((drill, "Not solved yet"), (replace(drill, passed=True), "Solved")):
        text, html = render_text(one), render_html(one)
        assert f"{said}. (" in text
        assert "PASS  The service is there\n" in text
        assert f"<strong>{said}</strong>" in html
        assert "ck-bar" not in html.rpartition("</style>")[2]
        for page in (text, html):
            assert "points" not in page.rpartition("</style>")[2]
            assert "1.5" not in page.rpartition("</style>")[2]


def test_text_lets_nothing_steer_the_terminal() -> None:
    wild = replace(FAILED, got="\x1b[2J\x07", message="line 3: x = '\x9b31m'", title="a\u202eb")
    text = render_text(replace(REPORT, submission="\x1b]0;me\x07.py", checks=(wild,)))
    assert all(character.isprintable() or character == "\n" for character in text)
    html = render_html(replace(REPORT, problem="\u202e\x1b", checks=(wild,), stdout="\x1b[2J"))
    assert not {"\x1b", "\x9b", "\u202e"} & set(html)


@pytest.mark.parametrize(
    ("said", "shown"),
    [
        ("👩‍👩‍👧 🏳️‍🌈 می‌خواهم क्‍ष", "👩‍👩‍👧 🏳️‍🌈 می‌خواهم क्‍ष"),
        ("pass\u200ded \u200cx", "pass\ufffded \ufffdx"),
        ("👩\u200d\u200d\u202e👧\u2066\u200d", "👩\u200d\ufffd\ufffd👧\ufffd\ufffd"),
        ("\u200d", "\ufffd"),
        ("a\tb\nc\r\x1b\u202e\x9b\u2028", "a\tb\nc" + 5 * "\ufffd"),
    ],
)
def test_joiners_stay_where_writing_needs_them(said: str, shown: str) -> None:
    assert make_printable(said) == shown
    assert make_printable(shown) == shown
    output = BoundedOutput()
    output.add(said.encode())
    assert output.text() == shown


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
    for words in ("(passed, 1.5 of 1.5)", "(not passed, 0 of 2)", "Every digit, 0 of 0.5", "1.5 of 4 points"):
        assert words in html
    assert "known_ids" not in html
    assert "Every entry belongs" in html
    assert "(passed, worth no points)" in html


def bars(html: str) -> list[tuple[float, float]]:
    """Length in em and filled share in percent of the bar of each check."""
    found = re.findall(r'class="ck-bar" style="width:([\d.]+)em"><span style="width:(\d+)%"', html)
    return [(float(length), float(share)) for length, share in found]


def test_each_check_with_points_has_a_bar_as_long_as_it_is_worth() -> None:
    assert bars(render_html(REPORT)) == [(6.0, 0), (4.5, 100)]
    assert bars(render_html(replace(REPORT, checks=(FREE,), max_score=0.0))) == []


def test_hints_come_one_after_the_other_behind_clicks() -> None:
    html = render_html(REPORT)
    assert html.count("Show a hint") == 1
    assert html.count("Show the next hint") == 2
    nested = html[html.index("Show a hint") :]
    places = [
        nested.index(text) for text in ("Think.", "Think &lt;again&gt;.", "Think at last.", "</details></details>")
    ]
    assert places == sorted(places)
    for element in re.findall(r'<details class="ck-hint"[^>]*>', html):
        assert "open" not in element


def test_only_the_first_failure_is_unfolded() -> None:
    html = render_html(replace(REPORT, checks=(PASSED, FAILED, SKIPPED, replace(FAILED, id="again"))))
    assert html.count("<details open>") == 1
    assert html.index("<details open>") < html.index(FAILED.title)


def test_diagram_shows_each_step_and_says_it_in_words() -> None:
    html = render_html(REPORT)
    drawing = html[html.index("<svg") : html.index("</svg>")]
    assert 'role="img"' in drawing
    assert "Sequence diagram of 4 steps between the grader and your node. The last one failed." in drawing
    assert "✗ no answer within 5 s" in drawing
    assert drawing.count("ck-arrow") == 6  # three that arrive: a line and a head each
    assert drawing.count("ck-fail") >= 2
    assert "<script" not in drawing
    words = html[html.index("The diagram in words") :]
    assert "<li>grader -&gt; your node: request /convert: value=100.0</li>" in words
    assert "your node -&gt; grader, not as expected: no answer within 5 s" in words


def test_link_leads_from_the_notebooks_folder_to_the_lesson() -> None:
    taught = replace(FAILED, diagnosis="service.no_return", known=catalogue()["service.no_return"])
    root = environment.checkout_folder()
    assert root is not None
    html = render_html(replace(REPORT, checks=(taught,)), root / "exercises" / "temperature_service")
    section = catalogue()["service.no_return"].section.replace(" ", "-")
    assert f'href="../../notebooks/01_services.ipynb#{section}"' in html
    assert catalogue()["service.no_return"].explanation.replace("'", "&#39;") in html
    assert 'href="notebooks/01_services.ipynb#' in render_html(replace(REPORT, checks=(taught,)), root)
    named = "diagnosis The callback does not return the response (service.no_return)"
    assert named in " ".join(render_text(replace(REPORT, checks=(taught,))).split())


def test_catalogue_has_all_for_each_code() -> None:
    for code, entry in catalogue().items():
        assert entry.title, code
        assert entry.explanation.endswith("."), code
        assert entry.hint.endswith((".", "?")), code
        assert entry.notebook.endswith(".ipynb") or (not entry.notebook and entry.section), code  # the exercise's own
        assert " " not in entry.link, code


def test_message_is_completed_with_why_and_where() -> None:
    text = complete_message("It happened.", catalogue()["service.no_return"])
    assert text.startswith("It happened. ")
    assert catalogue()["service.no_return"].explanation in text
    assert "notebooks/01_services.ipynb#" in text
    assert complete_message("It happened.", None) == "It happened."

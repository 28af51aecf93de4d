"""The drawing of what crossed: where everything stands, what is in it, and that it needs nothing but itself."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.lab.recording.diagram import Diagram
from course_kit.ros.sequence import Arrow

CALL = [
    Arrow("lab", "/adder", "request", "a=1, b=2", "/add"),
    Arrow("/adder", "lab", "response", "sum=3", "/add"),
    Arrow("/robot/adder", "lab", "failure", "no answer: ValueError: no", "/add"),
    Arrow("/talker", "/adder", "message", "data='x'", "/chatter"),
]


class Elements(HTMLParser):
    """All elements of a piece of HTML, with the text that stands right in each."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.found: list[tuple[str, dict[str, str | None], list[str]]] = []
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append((tag, dict(attrs), []))

    def handle_data(self, data: str) -> None:
        if self.found:
            self.found[-1][2].append(data)

    def of(self, tag: str) -> list[tuple[dict[str, str | None], str]]:
        return [(attributes, "".join(text).strip()) for name, attributes, text in self.found if name == tag]


def test_each_node_has_a_lifeline_and_each_step_an_arrow() -> None:
    elements = Elements(Diagram(CALL).html())
    texts = [text for _, text in elements.of("text")]
    assert texts[:4] == ["lab", "adder", "/robot/adder", "talker"]
    assert [attributes["class"] for attributes, _ in elements.of("g")] == ["ck-step"] * 4
    assert "✗ /add no answer: ValueError:" in " ".join(texts)
    assert len([attributes for attributes, _ in elements.of("line") if attributes["class"] == "ck-life"]) == 4


def test_the_summary_and_the_words_say_it_to_those_who_do_not_see_it() -> None:
    elements = Elements(Diagram(CALL, left_out=2).html())
    (svg, _), *_ = elements.of("svg")
    assert svg["aria-label"] == "Sequence diagram: 4 messages between lab, adder, /robot/adder, talker."
    assert [text for _, text in elements.of("li")] == [
        "lab -> adder  /add request: a=1, b=2",
        "adder -> lab  /add response: sum=3",
        "/robot/adder --x lab  /add no answer: ValueError: no",
        "talker -> adder  /chatter data='x'",
    ]
    assert "2 earlier lines are left out." in [text for _, text in elements.of("text")]


def test_nothing_is_fetched_and_no_colour_is_fixed_that_a_theme_could_swallow() -> None:
    html = Diagram(CALL).html()
    assert not re.findall(r"https?:|url\(|@import|<script|<link|<img", html)
    fixed = set(re.findall(r"#[0-9a-fA-F]{3,6}\b", html))
    assert fixed == {"#1565c0", "#d2453c"}  # behind the theme's: the focus ring, the slider and the cross


@pytest.mark.parametrize("count", [2, 3, 6])
def test_a_long_message_stays_between_its_lifelines(count: int) -> None:
    text = "name='" + "long words " * 12 + "'"
    arrows = [Arrow(f"/node_{one}", f"/node_{one + 1}", "message", text, "/chatter") for one in range(count - 1)]
    elements = Elements(Diagram(arrows).html())
    lines = [int(attributes["x1"] or 0) for attributes, _ in elements.of("line")]
    (svg, _), *_ = elements.of("svg")
    width = int(svg["width"] or 0)
    for attributes, shown in elements.of("text")[count:]:
        middle, half = int(attributes["x"] or 0), len(shown) * 7.3 / 2
        assert middle - half >= 0
        assert middle + half <= width
        assert half <= (lines[1] - lines[0]) / 2
    said = " ".join(shown for _, shown in elements.of("text")[count:])
    assert said.count("long words") >= 10 * (count - 1)


@given(st.text(), st.text(min_size=1))
def test_no_text_breaks_the_page(text: str, name: str) -> None:
    elements = Elements(Diagram([Arrow(name, "/a", "message", text, "/t"), *CALL]).html())
    assert len(elements.of("svg")) == 1
    assert len(elements.of("g")) == 5
    assert len(elements.of("li")) == 5
    assert not elements.of("script")

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from course_kit.lab.recording.diagram import WIDTH, Diagram
from course_kit.ros.sequence import Arrow

CALL = [
    Arrow("lab", "/adder", "request", "a=1, b=2", "/add"),
    Arrow("/adder", "lab", "response", "sum=3", "/add"),
    Arrow("/robot/adder", "lab", "failure", "no answer: ValueError: no", "/add"),
    Arrow("/talker", "/adder", "message", "data='x'", "/chatter"),
]


def test_the_text_is_numbered_lines() -> None:
    assert str(Diagram(CALL)) == (
        "1. lab -> adder  /add request: a=1, b=2\n"
        "2. adder -> lab  /add response: sum=3\n"
        "3. /robot/adder --x lab  /add no answer: ValueError: no\n"
        "4. talker -> adder  /chatter data='x'"
    )


def test_the_mermaid_text_is_a_sequence_diagram() -> None:
    assert Diagram(CALL, left_out=2).mermaid() == (
        "sequenceDiagram\n"
        "    accTitle: What crossed between the nodes\n"
        "    accDescr: 4 messages between lab, adder, /robot/adder, talker.\n"
        "    participant n1 as lab\n"
        "    participant n2 as adder\n"
        "    participant n3 as /robot/adder\n"
        "    participant n4 as talker\n"
        "    Note over n1: 2 earlier lines are left out.\n"
        "    n1->>n2: /add request: a=1, b=2\n"
        "    n2-->>n1: /add response: sum=3\n"
        "    n3--xn1: /add no answer: ValueError: no\n"
        "    n4-)n2: /chatter data='x'\n"
    )


def test_a_notebook_gets_both_and_an_empty_one_a_sentence() -> None:
    bundle = Diagram(CALL)._repr_mimebundle_()
    assert sorted(bundle) == ["text/html", "text/plain"]
    assert Diagram([])._repr_mimebundle_() == {
        "text/plain": "Nothing has been recorded yet: call a service, then draw again."
    }


@pytest.mark.parametrize(
    ("text", "escaped"),
    [
        ("a;b", "a#59;b"),
        ("#1", "#35;1"),
        ("two\nlines", "two lines"),
        ("<b>&", "#60;b#62;#38;"),
        ("%%{init", "#37;#37;#123;init"),
        ("the end", "the #101;nd"),
        ("Grüße 🤖", "Grüße 🤖"),
        ('"quoted"', '"quoted"'),
    ],
)
def test_mermaids_own_signs_are_escaped(text: str, escaped: str) -> None:
    line = Diagram([Arrow("lab", "/a", "message", text, "/t")]).mermaid().splitlines()[-1]
    assert line == f"    n1-)n2: /t {escaped}"


@given(st.text())
def test_no_text_breaks_the_form(text: str) -> None:
    diagram = Diagram([Arrow("lab", "/a", "message", text, "/t")])
    lines = diagram.mermaid().splitlines()
    assert len(lines) == 6
    assert re.fullmatch(r"    n1-\)n2: /t[^;{}<>%`]*", re.sub(r"#\d+;", "", lines[-1]))
    assert all(len(line) <= WIDTH for line in str(diagram).splitlines())

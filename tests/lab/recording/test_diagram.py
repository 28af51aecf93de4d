from __future__ import annotations

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


def test_a_notebook_gets_both_and_an_empty_one_a_sentence() -> None:
    bundle = Diagram(CALL)._repr_mimebundle_()
    assert sorted(bundle) == ["text/html", "text/plain"]
    assert Diagram([])._repr_mimebundle_() == {
        "text/plain": "Nothing has been recorded yet: call a service, then draw again."
    }


@given(st.text())
def test_no_text_makes_a_line_too_long(text: str) -> None:
    lines = str(Diagram([Arrow("lab", "/a", "message", text, "/t")])).splitlines()
    assert all(len(line) <= WIDTH for line in lines)

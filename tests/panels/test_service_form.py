"""A form that calls the real service, driven as the page drives it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node
from std_msgs.msg import Header
from std_srvs.srv import Empty

from course_kit import interfaces, lab, panels
from course_kit.lab.errors import FieldError
from course_kit.panels.form_view import field_rows
from course_kit.ros.showing import copy_message

if TYPE_CHECKING:
    from course_kit.panels.form_view import ServiceForm

pytestmark = pytest.mark.usefixtures("live_lab")


class Adder(Node):
    def __init__(self) -> None:
        super().__init__("adder")
        self.create_service(AddTwoInts, "add_two_ints", self.add)
        self.create_service(AddTwoInts, "divide", self.divide)
        self.create_service(Empty, "rest", lambda _, response: response)

    def add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        print("added")  # noqa: T201 - as learners do
        return response

    def divide(self, request: Any, response: Any) -> Any:
        response.sum = request.a // request.b
        return response


def type_and_send(form: ServiceForm, **values: object) -> dict[str, Any]:
    """What the page does on Enter."""
    form.widget._handle_custom_msg({"do": "send", "values": values}, [])
    return dict(form.widget.outcome)


@pytest.mark.parametrize(("a", "b"), [(20, 22), (2**62, 1)], ids=["", "beyond what JavaScript can count"])
def test_it_shows_the_response_and_what_the_callback_prints(a: int, b: int, capsys: pytest.CaptureFixture[str]) -> None:
    lab.start(Adder)
    shown = type_and_send(panels.service_form("/add_two_ints", AddTwoInts), a=str(a), b=str(b))
    assert (shown["state"], shown["rows"], shown["printed"]) == ("answered", [["sum", str(a + b)]], "added")
    assert capsys.readouterr().out == ""


def test_it_shows_the_comments_of_the_type_and_so_does_its_picture() -> None:
    named = interfaces.define("units_test/srv/Open", "float64 width  # metres\n---\nbool done  # open now\n")
    form = panels.service_form("/open", named)
    assert [one["comment"] for one in form.widget.entries] == ["metres"]
    assert "a number · metres" in form.still()

    class Gripper(Node):
        def __init__(self) -> None:
            super().__init__("gripper")
            self.create_service(named, "open", lambda _, response: response)

    lab.start(Gripper)
    assert type_and_send(form)["comments"] == {"done": "open now"}


def test_a_field_error_names_the_field_and_sends_nothing() -> None:
    lab.start(Adder)
    form = panels.service_form("/add_two_ints", AddTwoInts)
    shown = type_and_send(form, a="1", b="1.5")
    assert shown["state"] == "invalid"
    assert shown["errors"]["b"].startswith("Expected a whole number (int64, from ")
    assert shown["text"].startswith("b: expected a whole number")
    assert len(lab.diagram().arrows) == 0
    assert form.widget.values["b"] == "1.5"  # to be repaired, not typed again


@pytest.mark.parametrize(
    ("service", "words"),
    [
        ("/divide", ("adder sent no response", "ZeroDivisionError")),
        ("/add_two_integers", ("No node serves /add_two_integers", "/add_two_ints")),
    ],
)
def test_why_no_answer_came_is_said_in_words(service: str, words: tuple[str, ...]) -> None:
    lab.start(Adder)
    shown = type_and_send(panels.service_form(service, AddTwoInts), a="1", b="0")
    assert shown["state"] == "failed"
    assert all(part in shown["text"] for part in words)


def test_a_form_that_was_replaced_says_so_and_sends_nothing() -> None:
    lab.start(Adder)
    first = panels.service_form("/add_two_ints", AddTwoInts)
    again = panels.service_form("/add_two_ints", AddTwoInts)
    assert "ended" in first.widget.ended
    assert type_and_send(first, a="1") == {"state": "new"}
    assert type_and_send(again, a="1")["state"] == "answered"


def test_it_is_described_in_words_the_same_each_time() -> None:
    form = panels.service_form("/add_two_ints", AddTwoInts)
    assert form.describe() == (
        "A form that calls /add_two_ints [example_interfaces/srv/AddTwoInts].\n"
        "Request: a (int64), b (int64).\nResponse: sum (int64)."
    )
    bundle = form._repr_mimebundle_()
    assert bundle["text/plain"] == form.describe()
    assert "application/vnd.jupyter.widget-view+json" in bundle


def test_what_is_no_service_type_is_refused_in_words() -> None:
    with pytest.raises(FieldError, match=r"panels\.service_form"):
        panels.service_form("/add_two_ints", AddTwoInts.Request)
    with pytest.raises(FieldError):
        panels.service_form(AddTwoInts, "/add_two_ints")


def test_a_response_is_shown_field_by_field() -> None:
    copied = {"ok": True, "at": {"x": 1.0, "y": -2.0}, "names": ["a", "+3 more"], "none": []}
    assert field_rows(copied) == [
        ["ok", "True"],
        ["at.x", "1.0"],
        ["at.y", "-2.0"],
        ["names", "['a', +3 more]"],
        ["none", "[]"],
    ]


def test_rows_take_messages_apart() -> None:
    assert field_rows(copy_message(Header(frame_id="map"))) == [
        ["stamp.sec", "0"],
        ["stamp.nanosec", "0"],
        ["frame_id", "'map'"],
    ]

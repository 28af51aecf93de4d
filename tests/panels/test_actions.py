"""Goals sent by panels, to real servers."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import pytest
from example_interfaces.action import Fibonacci
from ipywidgets import HTML
from std_srvs.srv import Trigger

from course_kit import interfaces, lab, panels
from course_kit.lab.errors import FieldError
from course_kit.panels.goal_panel import GoalFollower, GoalState
from tests.panels.goal_panels import Gate
from tests.waiting import wait_until

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab
    from course_kit.panels.goal_panel import ActionPanel


pytestmark = pytest.mark.usefixtures("own_lab")


@pytest.fixture
def gate(own_lab: Lab) -> Gate:
    assert own_lab
    return lab.start(Gate)


@pytest.fixture(params=[False, True], ids=["known at once", "feedback comes first"])
def known(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> threading.Event:
    """Before this is set, a panel hears of its goal only by feedback."""
    event, send = threading.Event(), lab.send_goal_blocking
    if request.param:
        monkeypatch.setattr(lab, "send_goal_blocking", lambda *goal, **how: (send(*goal, **how), event.wait(60))[0])
    return event


class Seen(GoalFollower):
    """A panel without a page."""

    def __init__(self, action: str = "/gate") -> None:
        super().__init__(action)
        self.all: list[GoalState] = []
        self.widget = HTML()
        self._follow_goals(Fibonacci)

    @property
    def last(self) -> GoalState:
        return self._standing

    def _show(self, standing: GoalState) -> None:
        self.all.append(standing)

    def _take_wish(self, wish: dict[str, Any]) -> None:
        raise NotImplementedError

    def send(self, order: int) -> None:
        self.send_goal(Fibonacci.Goal(order=order)).join()

    def until(self, **wanted: Any) -> GoalState:
        wait_until(lambda: all(getattr(self.last, name) == value for name, value in wanted.items()), lambda: self.last)
        return self.last


def test_a_server_that_does_not_agree_to_cancel_is_quoted(gate: Gate) -> None:
    gate.agrees = False
    seen = Seen()
    seen.send(3)
    seen.until(count=1)
    seen.cancel().join()
    assert seen.last.note == "The server refuses to cancel it."
    assert seen.last.is_running
    gate.open.set()
    assert seen.until(status="SUCCEEDED").note == ""


@pytest.mark.usefixtures("gate")
def test_a_rejected_goal_is_no_error() -> None:
    seen = Seen()
    seen.send(-1)
    assert (seen.last.status, seen.last.is_running, seen.last.refused.order) == ("REJECTED", False, -1)


def test_a_server_that_goes_away_ends_its_goal(gate: Gate) -> None:
    seen = Seen()
    seen.send(9)
    seen.until(count=1)
    lab.stop(gate)
    wait_until(lambda: not seen.last.is_running, lambda: seen.last)
    assert seen.last.tone == "bad"


def test_an_end_cancels_what_still_runs_and_tells_no_more(gate: Gate, known: threading.Event) -> None:
    seen = Seen()
    sent = seen.send_goal(Fibonacci.Goal(order=9))
    seen.until(count=1)
    seen.close()
    told = len(seen.all)
    known.set()
    sent.join()
    assert gate.free.acquire(timeout=10)  # its execute callback has ended
    assert len(seen.all) == told


def view(panel: ActionPanel) -> dict[str, Any]:
    return dict(panel.widget.view)


def page_says(panel: ActionPanel, **wish: Any) -> None:
    panel.widget._handle_custom_msg({"values": dict(panel.widget.values), **wish}, [])


def test_a_panel_shows_a_goal_from_form_to_result(gate: Gate) -> None:
    panel = panels.action_panel("/gate", Fibonacci)
    assert view(panel)["status"] == "No goal yet."
    panel.fill({"order": "4"})
    page_says(panel, do="send")
    wait_until(lambda: view(panel)["running"] and view(panel)["rows"], lambda: view(panel))
    shown = view(panel)
    assert shown["status"] == "The goal is running (EXECUTING)."
    assert (shown["share"], shown["progress"]) == (0.5, "term 2 of 4")
    assert shown["rows"] == [["Feedback 1", "sequence=[0, 1, 1]"]]
    gate.open.set()
    wait_until(lambda: view(panel)["tone"] == "good", lambda: view(panel))
    shown = view(panel)
    assert (shown["status"], shown["share"], shown["progress"]) == ("The goal has succeeded (SUCCEEDED).", 1.0, "done")
    assert [name for name, _ in shown["rows"]] == ["Feedback 3", "Result"]
    assert {value for _, value in shown["rows"]} == {"sequence=[0, 1, 1, 2, 3]"}


@pytest.mark.usefixtures("gate")
def test_a_panel_cancels_also_when_feedback_comes_first(known: threading.Event) -> None:
    panel = panels.action_panel("/gate", Fibonacci)
    page_says(panel, do="send", values={"order": "9"})
    wait_until(lambda: view(panel)["running"], lambda: view(panel))
    panel.cancel().join()
    known.set()
    wait_until(lambda: view(panel)["status"] == "The goal was cancelled (CANCELED).", lambda: view(panel))
    assert (view(panel)["tone"], view(panel)["rows"][-1]) == ("stopped", ["Result", "sequence=[0, 1, 1]"])


@pytest.mark.usefixtures("gate")
def test_what_is_no_number_is_not_sent() -> None:
    panel = panels.action_panel("/gate", Fibonacci)
    page_says(panel, do="send", values={"order": "three"})
    wait_until(lambda: view(panel)["errors"], lambda: view(panel))
    assert list(view(panel)["errors"]) == ["order"]
    assert view(panel)["status"].startswith("Not sent")
    page_says(panel, do="send", values={"order": "-3"})
    wait_until(lambda: "REJECTED" in view(panel)["status"], lambda: view(panel))
    assert view(panel)["errors"] == {}


def test_a_panel_takes_any_action_type() -> None:
    tour = interfaces.define(
        "panel_test_interfaces/action/Tour",
        "geometry_msgs/Point[] stops\nbool back\n---\nfloat64 length\n---\nuint8 stop\n",
    )
    panel = panels.action_panel("/tour", tour)
    assert set(panel.widget.values) == {"stops", "back"}
    assert "Goal: stops (geometry_msgs/Point[]), back (bool)." in panel.describe()


def test_a_panel_again_ends_the_one_before_and_its_goal(gate: Gate) -> None:
    first = panels.action_panel("/gate", Fibonacci)
    page_says(first, do="send", values={"order": "9"})
    wait_until(lambda: view(first)["running"], lambda: view(first))
    second = panels.action_panel("/gate", Fibonacci)
    assert gate.free.acquire(timeout=10)
    gate.free.release()
    assert view(first)["ended"]
    assert not view(second)["ended"]
    page_says(first, do="send")
    assert view(second)["status"] == "No goal yet."


def test_a_service_type_is_refused_in_words() -> None:
    with pytest.raises(FieldError, match="action type"):
        panels.action_panel("/gate", Trigger)

"""What every panel can rely on."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import ipywidgets
import pytest

from course_kit.panels.base import LatestValue, Panel

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab

pytestmark = pytest.mark.usefixtures("own_lab")


class Lamp(Panel):
    """A panel with nothing on the graph."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.label = ipywidgets.Label(name)
        self.ended = 0
        self.at_close(self.count)

    @property
    def widget(self) -> Any:
        return self.label

    def describe(self) -> str:
        return f"A lamp called {self.label.value}."

    def count(self) -> None:
        self.ended += 1


def test_a_panel_is_a_widget_for_a_notebook_a_sentence_and_a_picture_for_the_rest() -> None:
    bundle = Lamp("<red>")._repr_mimebundle_()
    assert bundle["text/plain"] == "A lamp called <red>."
    assert "A lamp called &lt;red&gt;." in bundle["text/html"]
    assert "application/vnd.jupyter.widget-view+json" in bundle


def test_the_same_panel_again_replaces_the_one_before_and_all_end_with_the_lab_once(own_lab: Lab) -> None:
    first, other = Lamp("red"), Lamp("green")
    again = Lamp("red")
    assert (first.ended, other.ended, again.ended) == (1, 0, 0)
    own_lab.close()
    again.close()
    assert (first.ended, other.ended, again.ended) == (1, 1, 1)


def test_the_last_value_is_shown_and_the_burst_before_it_is_not() -> None:
    shown: list[int] = []
    begun, go_on = threading.Event(), threading.Event()

    def show(value: int) -> None:
        shown.append(value)
        begun.set()
        go_on.wait(10)

    updates = LatestValue(show)
    updates.put(0)
    assert begun.wait(10)
    for value in range(1, 500):
        updates.put(value)
    go_on.set()
    updates.close()
    assert shown == [0, 499]

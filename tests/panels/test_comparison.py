"""Measured numbers side by side."""

from __future__ import annotations

import pytest

from course_kit import panels

pytestmark = pytest.mark.usefixtures("own_lab")


def test_numbers_are_shown_and_only_their_order_is_stored() -> None:
    panel = panels.compare("Time <to> know", {"topic": 250.0, "service": 1.25, "action": 5.0, "nothing": 0.0}, "ms")
    bundle = panel._repr_mimebundle_()
    assert bundle["text/plain"] == "Time <to> know, smallest first: nothing, service, action, topic."
    assert set(bundle) == {"text/plain", "text/html"}  # a widget would be dead on the next day
    shown = bundle["text/html"]
    assert "Time &lt;to&gt; know" in shown
    assert all(number in shown for number in ("250 ms", "1.25 ms", "5 ms"))
    assert all(width in shown for width in ("width:100.0%", "width:0.5%", "width:2.0%", "width:0.0%"))


@pytest.mark.parametrize("values", [{}, {"a": -1.0}, {"a": float("nan")}, {"a": 1.0, "b": float("inf")}])
def test_what_is_no_length_is_refused(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="at least one number"):
        panels.compare("Times", values, "ms")

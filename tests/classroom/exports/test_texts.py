"""Cells and HTML out of whatever people call themselves."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from course_kit.classroom.exports import texts
from course_kit.text.sanitize import make_printable

FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")


@given(st.text())
@example("\r\n")
def test_a_cell_is_the_text_or_an_apostrophe_and_the_text(text: str) -> None:
    shown = make_printable(text)
    assert texts.csv_cell(text) in (shown, f"'{shown}")
    assert not texts.csv_cell(text).startswith(FORMULA_STARTS) or float(text) < 0


@pytest.mark.parametrize(
    ("value", "cell"),
    [
        (8.0, "8"),
        (7.5, "7.5"),
        (-1.5, "-1.5"),
        (0, "0"),
        (1e7, "10000000"),
        (1 / 3, "0.333333"),
        (None, ""),
        ("-5", "-5"),
    ],
)
def test_numbers_stay_numbers(value: str | float | None, cell: str) -> None:
    assert texts.csv_cell(value) == cell

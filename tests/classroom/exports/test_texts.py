"""Cells and HTML out of whatever people call themselves."""

from __future__ import annotations

import csv
import io
from html.parser import HTMLParser

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from course_kit.classroom.exports import texts
from course_kit.text.sanitize import escaped, printable
from tests.classroom.exports.books import HOSTILE

FORMULA_STARTS = ("=", "+", "-", "@", "\t", "\r", "\n")


@pytest.mark.parametrize("name", HOSTILE)
def test_no_cell_begins_a_formula(name: str) -> None:
    cell = texts.cell(name)
    assert not cell.startswith(FORMULA_STARTS)
    assert not cell.strip(" \u200b\ufeff\u00a0").startswith(FORMULA_STARTS)


@given(st.text())
@example("\r\n")
def test_a_cell_is_the_text_or_an_apostrophe_and_the_text(text: str) -> None:
    shown = printable(text)
    assert texts.cell(text) in (shown, f"'{shown}")
    assert not texts.cell(text).startswith(FORMULA_STARTS) or float(text) < 0


@pytest.mark.parametrize("wide", ["＝1+1", "＋1", "－1", "＠x"])  # noqa: RUF001
def test_the_wide_signs_of_east_asian_keyboards_begin_none_either(wide: str) -> None:
    assert texts.cell(wide) == f"'{wide}"


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
    assert texts.cell(value) == cell


def test_rows_come_back_out_of_the_csv_as_they_went_in() -> None:
    rows = [[name, "plain"] for name in HOSTILE if texts.cell(name) == name]
    assert list(csv.reader(io.StringIO(texts.csv_text(rows), newline=""))) == rows


@pytest.mark.parametrize("name", HOSTILE)
def test_html_shows_every_name_and_runs_none(name: str) -> None:
    tags, data = [], []

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            tags.append((tag, attrs))

        def handle_data(self, text: str) -> None:
            data.append(text)

    reader = Reader()
    reader.feed(f'<p title="{escaped(name)}">{escaped(name)}</p>')
    reader.close()
    assert [tag for tag, _ in tags] == ["p"]
    assert dict(tags[0][1])["title"] == "".join(data)
    assert "\u202e" not in "".join(data)


def test_joined_emoji_and_persian_stay_whole() -> None:
    for text in ("👩‍👩‍👧", "می‌خواهم", "🏳️‍🌈"):
        assert escaped(text) == texts.cell(text) == text

"""How a learner sees their scenarios."""

from __future__ import annotations

import ast
from html.parser import HTMLParser
from pathlib import Path

from course_kit import environment, quiz

FOLDER = (environment.checkout_folder() or Path()) / "exercises" / "pattern_choice"


def entries(text: str) -> dict[str, tuple[str, str]]:
    return dict(ast.literal_eval(ast.parse(text).body[-1].value))


def test_text_shows_everything_in_80_columns() -> None:
    text = repr(quiz.show(5))
    assert max(map(len, text.splitlines())) <= 80
    flat = " ".join(text.split())
    for scenario in quiz.draw(5):
        assert f"[{scenario.id}]" in flat
        assert scenario.text in flat
        assert all(f"{name}: {reason}" in flat for name, reason in scenario.reasons.items())


def test_html_shows_everything_and_is_well_formed() -> None:
    page = quiz.show(5)._repr_html_()
    opened: list[str] = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, _attrs: object) -> None:
            opened.append(tag)

        def handle_endtag(self, tag: str) -> None:
            assert opened.pop() == tag

    Reader().feed(page)
    assert not opened
    for scenario in quiz.draw(5):
        assert f"<code>{scenario.id}</code>" in page
        assert all(f"<dt>{name}</dt>" in page for name in scenario.reasons)


def test_neither_tells_what_is_right() -> None:
    shown = repr(quiz.show(5)) + quiz.show(5)._repr_html_() + quiz.show(5).sheet()
    for scenario in quiz.draw(5):
        assert scenario.why not in " ".join(shown.split())


def test_the_sheet_is_python_with_an_empty_pair_for_each() -> None:
    found = entries(quiz.show(5).sheet())
    assert found == {scenario.id: ("", "") for scenario in quiz.draw(5)}
    assert entries(quiz.show(5).form()) == found


def test_the_starter_is_the_sheet_of_the_default_seed() -> None:
    assert (FOLDER / "pattern_choice.py").read_text() == quiz.show().sheet()


def test_the_notebook_holds_the_form_of_the_default_seed() -> None:
    from tests.reading import read

    handed_in = read(FOLDER / "pattern_choice.ipynb", "pattern_choice")
    assert handed_in.source.strip() == quiz.show().form()

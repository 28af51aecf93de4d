"""The class page as an instructor uses it: opened from a folder, sorted and searched by keyboard, and printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from course_kit.classroom import exports
from course_kit.classroom.records import Records
from tests.browser.learner import ARTIFACTS, page
from tests.exports import books
from tests.exports.programs import ORIGINAL, OTHER, class_of, disguised

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Page

pytestmark = pytest.mark.browser


def written(out: Path) -> str:
    """The page of a mixed class, with look-alikes and with reports to link to; its address."""
    alike = class_of(out / "in", ann=ORIGINAL, bob=OTHER, cid=disguised(ORIGINAL))
    class_ = books.large_book(24)
    hostile = books.hostile_book().records
    half = books.record("half", [books.check("first"), books.check("second", "failed")])
    gradebook = books.book(
        half,
        *class_.records,
        *hostile,
        *alike,
        exercises=class_.exercises,
        left=(("notes.txt", "no program"),),
        root=out / "in",
    )
    for record in gradebook.records:
        Records(out).keep(record, f"<!DOCTYPE html><h1>Report of {record.entry.exercise}</h1>")
    return exports.write_all(gradebook, out).as_uri()


def column(opened: Page, number: int) -> list[str]:
    return opened.locator(f"#class tbody tr > :nth-child({number})").all_inner_texts()


def test_the_class_page(tmp_path: Path) -> None:
    address = written(tmp_path)
    with page() as opened:
        said: list[str] = []
        opened.on("console", lambda message: said.append(message.text))
        opened.on("request", lambda request: said.append(request.url) if "file:" not in request.url else None)
        opened.goto(address)
        expect(opened.get_by_role("heading", level=1)).to_contain_text("Class results")
        ARTIFACTS.mkdir(parents=True, exist_ok=True)
        opened.screenshot(path=ARTIFACTS / "class_page.png", full_page=True)
        sort_by_keyboard(opened)
        find_somebody(opened)
        expect(opened.get_by_role("row", name="ann")).to_contain_text(["cid"])
        print_it(opened)
        follow_a_link(opened)
        assert said == []


def totals(texts: list[str]) -> tuple[list[float], list[str]]:
    """The totals, and after them, whichever way they are sorted, those that are not known yet."""
    known = len([text for text in texts if text != "not known yet"])
    return [float(text) for text in texts[:known]], texts[known:]


def sort_by_keyboard(opened: Page) -> None:
    heading = opened.locator("#class thead th").last
    total = len(opened.locator("#class thead th").all())
    heading.get_by_role("button", name="Total").focus()
    opened.keyboard.press("Enter")
    expect(heading).to_have_attribute("aria-sort", "ascending")
    scores, unknown = totals(column(opened, total))
    assert unknown, "the grader has failed for somebody"
    assert scores == sorted(scores)
    assert {5.0, 10.0} < set(scores), "in the alphabet's order 10 comes before 5"
    opened.keyboard.press("Space")
    expect(heading).to_have_attribute("aria-sort", "descending")
    assert totals(column(opened, total)) == (sorted(scores, reverse=True), unknown)
    expect(opened.get_by_role("status").filter(has_text="Sorted by Total, descending.")).to_be_attached()
    for _ in range(2):  # whoever is missing comes last, whichever way
        opened.locator("#class thead th").nth(total - 2).get_by_role("button").press("Enter")
        assert "missing" in column(opened, total - 1)[-1]
        assert "missing" not in column(opened, total - 1)[0]
    opened.locator("#class thead th").first.get_by_role("button").press("Enter")
    assert opened.locator("#class th[aria-sort]").count() == 1


def find_somebody(opened: Page) -> None:
    opened.get_by_label("Find a student").fill("MÜLLER")
    expect(opened.locator("#class tbody tr:visible")).to_have_count(1)
    expect(opened.locator("#found")).to_contain_text("1 of")
    opened.get_by_label("Find a student").fill("")


def print_it(opened: Page) -> None:
    """On paper everything is unfolded, and what is for the screen is gone."""
    folded = opened.locator("details:not([open])")
    before = folded.count()
    opened.emulate_media(media="print")
    expect(opened.get_by_role("navigation")).to_be_hidden()
    expect(opened.get_by_label("Find a student")).to_be_hidden()
    opened.evaluate("dispatchEvent(new Event('beforeprint'))")
    expect(folded).to_have_count(0)
    opened.evaluate("dispatchEvent(new Event('afterprint'))")
    expect(folded).to_have_count(before)
    opened.emulate_media(media="screen")


def follow_a_link(opened: Page) -> None:
    link = opened.locator("#class tbody tr", has_text="<script>").get_by_role("link").first
    link.focus()
    opened.keyboard.press("Enter")
    expect(opened.get_by_role("heading", level=1)).to_have_text("Report of temperature_service")


def test_without_javascript_everything_is_there(tmp_path: Path) -> None:
    address = written(tmp_path)
    with page() as opened:
        plain = opened.context.browser.new_context(java_script_enabled=False).new_page()
        plain.goto(address)
        expect(plain.locator("#class tbody tr").first).to_be_visible()
        expect(plain.get_by_label("Find a student")).to_be_hidden()
        expect(plain.locator("#class thead button")).to_have_count(0)
        plain.locator("#class tbody").get_by_role("link").first.click()
        expect(plain.get_by_role("heading", level=1)).to_contain_text("Report of")

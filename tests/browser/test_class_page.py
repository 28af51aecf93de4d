"""The class page as an instructor uses it: opened from a folder, sorted and searched by keyboard, and printed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from course_kit.classroom import exports
from course_kit.classroom.records import RecordFolder
from course_kit.grading.model.exercise import load_exercise
from tests.browser.learner import ARTIFACTS, page
from tests.browser.test_report_card import contrast
from tests.classroom.exports import books, real_class
from tests.classroom.exports.programs import ORIGINAL, OTHER, class_of, disguised

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Page

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]


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
        RecordFolder(out).keep(record, f"<!DOCTYPE html><h1>Report of {record.entry.exercise}</h1>")
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


HIGHEST = 15_000  # pixels of a page of 300 students
SIZES = [(1400, "light"), (400, "dark")]
# Every text in a picture and every coloured cell, which axe passes over: its colour, and the one that is behind it.
COLOURS = """() => [...document.querySelectorAll('svg text, td.heat, .count, .meter + .share')].map(one => {
    const style = getComputedStyle(one);
    const canvas = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
    return [one.closest('svg') && one.tagName === 'text' ? style.fill : style.color,
            getComputedStyle(one.closest('section')).backgroundColor, style.backgroundColor].map(colour => {
        canvas.fillStyle = colour;
        canvas.fillRect(0, 0, 1, 1);
        return [...canvas.getImageData(0, 0, 1, 1).data];
    });
})"""


# One of each kind, for axe takes a minute for some thousand links.
UNFOLD = """() => document.querySelectorAll(
    '.group, section > details, figure > details, tbody tr:first-child details, li > details, .ck-exchange > details'
).forEach(one => { one.open = true; })"""


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The class page of 300."""
    return real_class.write(tmp_path_factory.mktemp("class"))


@pytest.fixture(scope="module")
def chromium_page() -> Iterator[Page]:
    with page() as opened:
        yield opened


@pytest.mark.parametrize(("width", "scheme"), SIZES)
def test_three_hundred_students_on_a_page_that_anybody_can_read(
    large: Path, chromium_page: Page, width: int, scheme: str
) -> None:
    opened = chromium_page
    fetched: list[str] = []
    opened.on("request", lambda request: fetched.append(request.url))
    look(opened, large, width, scheme)
    assert opened.evaluate("document.documentElement.scrollHeight") < HIGHEST
    assert opened.evaluate("document.documentElement.scrollWidth") <= width, "long names make it wider than the screen"
    assert opened.locator("#class tbody tr").count() >= real_class.STUDENTS
    ARTIFACTS.mkdir(parents=True, exist_ok=True)
    opened.screenshot(path=ARTIFACTS / f"class_of_300_{width}_{scheme}.png")
    without_findings(opened)
    assert fetched == [large.as_uri()], "it is one file"


def test_the_totals_of_three_exercises_are_on_a_small_screen(tmp_path: Path, chromium_page: Page) -> None:
    exercises = tuple(load_exercise(one) for one in ("temperature_service", "move_robot", "robot_parameters"))
    people = {"jane.doe@university.example": "Jane Doe-Whittington", "4711": "Jörg Müller"}
    checks = [books.check("first"), books.check("second", "failed")]
    records = [books.record(who, checks, of=one, name=name) for who, name in people.items() for one in exercises]
    look(chromium_page, exports.write_all(books.book(*records, exercises=exercises), tmp_path), 1280, "light")
    right = "one => one.getBoundingClientRect().right"
    last, around = chromium_page.locator("#class thead th").last, chromium_page.locator(".wide:has(#class)")
    assert last.inner_text().startswith("Total")
    assert last.evaluate(right) <= around.evaluate(right)


@pytest.mark.parametrize(("width", "scheme"), SIZES)
@pytest.mark.parametrize("kind", ["comparison", "report"])
def test_what_it_leads_to_can_be_read_by_anybody_too(  # noqa: PLR0913, PLR0917 - two pages in each size
    large: Path, chromium_page: Page, tmp_path: Path, kind: str, width: int, scheme: str
) -> None:
    path = large.parent / "lookalikes/1.html" if kind == "comparison" else real_class.write_a_report(tmp_path)
    look(chromium_page, path, width, scheme)
    assert chromium_page.evaluate("document.documentElement.scrollWidth") <= width
    without_findings(chromium_page)


def look(opened: Page, path: Path, width: int, scheme: str) -> None:
    opened.set_viewport_size({"width": width, "height": 1000})
    opened.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    opened.goto(path.as_uri())


def without_findings(opened: Page) -> None:
    """Unfolded, which shows what is there folded, too: no finding of axe, and every text at 4.5:1."""
    opened.evaluate(UNFOLD)
    found = Axe().run(opened).response["violations"]
    assert found == [], [(one["id"], one["nodes"][0]["html"][:200]) for one in found]
    for text, ground, cell in opened.evaluate(COLOURS):
        share = cell[3] / 255
        behind = [share * over + (1 - share) * under for over, under in zip(cell[:3], ground[:3], strict=True)]
        assert contrast(*("rgb({}, {}, {})".format(*colour[:3]) for colour in (text, behind))) >= 4.5


def test_a_line_that_a_failed_check_speaks_of_is_marked_in_the_report(chromium_page: Page, tmp_path: Path) -> None:
    look(chromium_page, real_class.write_a_report(tmp_path), 1400, "light")
    chromium_page.get_by_role("link", name="line 16").click()
    marked = chromium_page.get_by_role("row", name="16")
    expect(marked).to_be_in_viewport()
    expect(marked).to_contain_text("← A request gets an answer")
    expect(chromium_page.locator("tr.marked")).to_have_count(1)


def test_a_click_lists_the_students_behind_a_number_and_leads_to_their_reports(
    large: Path, chromium_page: Page
) -> None:
    opened = chromium_page
    look(opened, large, 1400, "light")
    check = opened.locator("#checks tbody tr", has_text="Celsius becomes Fahrenheit").first
    listed = check.get_by_role("link")
    expect(listed.first).to_be_hidden()
    check.locator("summary").click()
    expect(listed.first).to_be_visible()
    assert listed.count() == int(check.locator("td").nth(1).inner_text())
    name = listed.first.locator("bdi").first.inner_text()
    listed.first.click()
    expect(opened.get_by_role("heading", level=1)).to_have_text(name)
    opened.go_back()
    opened.locator("#alike").get_by_role("link", name="side by side").first.click()
    expect(opened.get_by_role("columnheader", name="Same")).to_be_visible()
    opened.get_by_role("link", name="Back to the class").click()
    expect(opened.get_by_role("heading", name="Class results")).to_be_visible()

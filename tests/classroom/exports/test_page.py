"""The class page without a browser: what it says, that nothing of it runs or is fetched, and how fast it is made."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from typing import TYPE_CHECKING
from urllib.parse import unquote

import pytest

from course_kit.classroom import exports
from course_kit.classroom.exports import page
from course_kit.classroom.records import RecordFolder
from tests.classroom.exports import books
from tests.classroom.exports.books import HOSTILE, SERVICE, bad, book, good, not_graded, unreadable

if TYPE_CHECKING:
    from pathlib import Path

VOID = {"meta", "input", "br", "path", "rect"}


class Document(HTMLParser):
    """Every element closed where it was opened; tags, ids, links and tables as found."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] not in ("script", "style"):
            self.text += data

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


BOOKS = {
    "empty": book(),
    "nobody has anything": book(missing=(("jane", SERVICE.id),)),
    "one": book(good("jane")),
    "the grader failed for all": book(not_graded("jane")),
    "hostile": books.hostile_book(),
}


@pytest.mark.parametrize("name", BOOKS)
def test_the_page_is_whole_and_accessible_html(name: str) -> None:
    document = Document(page.render_class(BOOKS[name]))
    ids = [attributes["id"] for _, attributes in document.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    links = [str(link["href"]) for link in document.all("a")]
    assert {link[1:] for link in links if link.startswith("#")} <= {*ids, "students"}
    tables = document.all("table")
    assert len(document.all("caption")) == len(tables)
    assert all(heading.get("scope") in ("col", "row") for heading in document.all("th"))
    assert all(svg.get("aria-label") or svg.get("aria-hidden") for svg in document.all("svg"))
    assert document.all("html")[0]["lang"] == "en"
    assert len(document.all("h1")) == len(document.all("main")) == 1


def test_strangers_text_is_shown_and_steers_nothing() -> None:
    text = page.render_class(books.hostile_book())
    document = Document(text)
    for name in HOSTILE:
        shown = re.sub("[\x00-\x08\x0b-\x1f\x7f\u200b\u202e\ud800-\udfff]", "\ufffd", name)
        assert shown in document.text
    assert "\u202e" not in text
    assert not any(name.startswith("on") for _, attributes in document.tags for name in attributes)
    text.encode()


def test_links_lead_to_the_reports(tmp_path: Path) -> None:
    gradebook = books.hostile_book()
    for one in gradebook.records:
        RecordFolder(tmp_path).keep(one, "<p>report")
    found = exports.write_all(gradebook, tmp_path)
    links = {str(link["href"]) for link in Document(found.read_text(encoding="utf-8")).all("a")}
    reports = {link for link in links if link.startswith("students/")}
    assert len(reports) == len(HOSTILE)
    assert all((tmp_path / unquote(link)).is_file() for link in reports)


def test_it_says_how_the_class_did() -> None:
    gradebook = book(
        good("jane", name="Jane Doe", late=True),
        bad("jörg", size=12_345),
        unreadable("li"),
        not_graded("ole"),
        missing=(("eve", SERVICE.id),),
        left=(("notes.txt", "it belongs to none of these exercises"),),
        layout="canvas",
        complete=False,
        dropped=(("zoe", "zoe: it is a link, and links are not followed"),),
        odd=(("yan", "its name does not follow the layout 'canvas'"),),
    )
    text = Document(page.render_class(gradebook)).text
    for part in (
        "Canvas",
        "Seed of the checks: 7",
        "--resume",
        "1 of 3 submissions passed",
        "Could not be graded",
        "the grader's fault",
        "the worker was gone",
        "Handed in, but not graded",
        "zoe: it is a link, and links are not followed",
        "Graded, each entry as a separate student",
        "its name does not follow the layout 'canvas'",
        "10 of 10",
        "passed, late",
        "not graded",
        "grader's error",
        "– missing",  # noqa: RUF001
        "service.no_return",
        "12.3\u00a0kB",
        "1.25\u00a0s",
        "notes.txt",
        "it belongs to none of these exercises",
        "Missing submissions",
        "Similarity is not proof.",
    ):
        assert part in text, part

"""The site to read before installing: made without a warning, no link is broken, nothing comes from elsewhere."""

from __future__ import annotations

import functools
import subprocess
import sys
import threading
import urllib.parse
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import TYPE_CHECKING

import bs4
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook, new_output
from playwright.sync_api import sync_playwright

from course_kit import interfaces, lab, panels
from course_kit.authoring import corpus
from course_kit.dev import suite
from course_kit.dev.site import command
from tests.browser.learner import CHROMIUM_FLAGS
from tests.browser.pictures import require_no_findings
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from playwright.sync_api import Page

    Pages = Mapping[Path, bs4.BeautifulSoup]

WIDGET = "application/vnd.jupyter.widget-view+json"
LINKS = {"a": "href", "link": "href", "img": "src", "script": "src"}
GUIDES = (
    "guides/machines",
    "guides/monday",
    "guides/instructors",
    "guides/platforms",
    "authoring/AUTHORING",
    "grading/LIMITS",
)
LESSON = "notebooks/01_services.html"


class Quiet(SimpleHTTPRequestHandler):
    """A web server that does not print what it is asked for."""

    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """A folder at an address of this machine."""
    with ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=folder)) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield f"http://127.0.0.1:{server.server_address[1]}"
        finally:
            server.shutdown()
            thread.join()


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the command makes, which has nothing to say but where it is."""
    folder = tmp_path_factory.mktemp("published") / "site"
    made = subprocess.run(
        [sys.executable, "-m", "course_kit", "dev", "site", "--to", str(folder)],
        cwd=folder.parent,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert (made.returncode, made.stderr) == (0, "")
    assert made.stdout == f"course-kit: the site is there. Open {folder / 'index.html'}\n"
    assert list(folder.parent.iterdir()) == [folder]
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> Pages:
    return {path: bs4.BeautifulSoup(path.read_text(encoding="utf-8"), "html.parser") for path in site.rglob("*.html")}


def faults_of_links(pages: Pages) -> list[str]:
    """Links within the site that lead to no file or no anchor, and what a page would fetch from another host."""
    anchors = {path: {one["id"] for one in page.find_all(id=True)} for path, page in pages.items()}
    faults = []
    for path, page in pages.items():
        for found in page.find_all([*LINKS]):
            link = urllib.parse.urlsplit(found.get(LINKS[found.name], ""))
            if link.scheme or link.netloc:
                faults += [f"{path.name} fetches {link.geturl()}"] if found.name != "a" and link.netloc else []
                continue
            target = Path(path.parent, urllib.parse.unquote(link.path)).resolve() if link.path else path
            anchor = urllib.parse.unquote(link.fragment)
            if not target.is_file() or (anchor and anchor not in anchors.get(target, {anchor})):
                faults.append(f"{path.name}: {link.geturl()}")
    return faults


@pytest.mark.timeout(400)
def test_the_site_has_every_page_and_every_link_in_it_leads_somewhere(site: Path, pages: Pages) -> None:
    drills = sorted((REPOSITORY / "exercises/drills").glob("*/*.ipynb"))
    names = [path.relative_to(REPOSITORY) for path in [*suite.list_with_outputs(REPOSITORY, drills=False), *drills]]
    names += [Path("exercises", one, f"{one}.ipynb") for one in corpus.all_exercises(REPOSITORY)]
    names += [Path("course_kit", f"{name}.md") for name in GUIDES]
    missing = [name for name in names if site / name.with_suffix(".html") not in pages]
    assert missing == []
    assert len(names) > 30
    assert faults_of_links(pages) == []
    for module in (lab, panels, interfaces):
        known = {one["id"] for one in pages[site / f"reference/{module.__name__[11:]}.html"].find_all("dt", id=True)}
        assert {f"{module.__name__}.{name}" for name in module.__all__} <= known
    for command_line, verb in {"course_kit": "course-kit-class", "ros2": "ros2-topic-pub"}.items():
        assert pages[site / f"reference/{command_line}.html"].find(id=verb)


def test_each_panel_is_a_picture_and_answers_are_folded(pages: Pages, site: Path) -> None:
    lesson = pages[site / LESSON]
    assert len(lesson.select(".ck-exchange svg")) == 2
    assert len(lesson.select(".ck-still")) == 3
    answers = lesson.find_all("details")
    assert len(answers) > 20
    assert not [one for one in answers if one.has_attr("open") or len(one.get_text()) < 40]
    assert not [path for path, page in pages.items() if "Loading widget" in page.get_text() or WIDGET in str(page)]
    program = next(one for one in lesson.find_all("pre") if one.get_text().startswith("%%ros_script"))
    assert "import" in [one.get_text() for one in program.select(".kn")]  # its lines have colours


@pytest.mark.browser
@pytest.mark.timeout(400)
def test_the_pages_ask_no_other_host_and_are_readable_by_everybody(site: Path) -> None:
    asked: set[str] = set()
    failed: list[str] = []
    with served(site) as address, sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=suite.find_browser(), args=CHROMIUM_FLAGS)
        for scheme in ("light", "dark"):
            page = chromium.new_page(viewport={"width": 400, "height": 900}, color_scheme=scheme)
            page.on("request", lambda request: asked.add(urllib.parse.urlsplit(request.url).netloc))
            page.on("requestfailed", lambda request: failed.append(request.url))
            page.on("pageerror", lambda error: failed.append(str(error)))
            for name in ("index.html", LESSON, "reference/lab.html"):
                page.goto(f"{address}/{name}")
                assert page.evaluate("document.documentElement.scrollWidth") == 400
                if name != "reference/lab.html":
                    require_no_findings(page, page.locator("html"))
            require_found(page, "Deadlock")
            page.close()
        chromium.close()
    assert asked == {address.removeprefix("http://")}
    assert failed == []


def require_found(page: Page, word: str) -> None:
    """Search for a word as a reader does."""
    page.goto(f"{page.url.rpartition('/reference')[0]}/search.html?q={word}")
    page.locator("#search-results li a", has_text="deadlock").first.wait_for()


def test_a_notebook_is_made_readable() -> None:
    view = {"model_id": "m", "version_major": 2, "version_minor": 0}
    shown = new_output("display_data", {WIDGET: view, "text/html": "<b>a picture</b>", "text/plain": "words"})
    text = "[see](01_services.ipynb#7.4-A-deadlock) <details><summary>Why?</summary>\n\nSo. </details>"
    made = command.for_reading(new_notebook(cells=[new_markdown_cell(text), new_code_cell("x", outputs=[shown])]))
    assert "(01_services.ipynb#74-a-deadlock)" in made.cells[0].source
    assert made.cells[0].source.endswith("So.\n\n</details>")
    assert list(made.cells[1].outputs[0].data) == ["text/html", "text/plain"]

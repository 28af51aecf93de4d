"""A demo before a class: what the projected page shows, the button for the repair, and the speaker's window."""

from __future__ import annotations

import json
import re
import urllib.error
import urllib.request
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

import nbformat
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import expect

from course_kit.presentation import preparing
from tests.browser.learner import ARTIFACTS, page, served
from tests.course_copy import REPOSITORY, copy_with_notebooks
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Locator, Page

pytestmark = [pytest.mark.browser, pytest.mark.answers, pytest.mark.timeout(900)]

SIZES = [(1280, 900, "light"), (900, 700, "dark")]
# What JupyterLab has around a notebook.
AROUND = (
    "#jp-top-panel, #jp-menu-panel, #jp-main-statusbar, .jp-SideBar, .lm-DockPanel-tabBar, .jp-NotebookPanel-toolbar"
)
TOO_WIDE = """() => [...document.querySelectorAll(
    '.jp-WindowedPanel-outer, .cm-scroller, .jp-OutputArea-output, .jp-OutputArea-output pre, .jp-RenderedMarkdown'
)].filter(one => one.scrollWidth > one.clientWidth).map(one => one.innerText.slice(0, 200))"""


@dataclass
class Stage:
    """The projected page, and who stands beside it."""

    page: Page
    address: str
    token: str

    def open(self, demo: str) -> None:
        self.page.goto(f"{self.address}/doc/tree/notebooks/demos/{demo}.ipynb?token={self.token}&reset")
        expect(self.bar.get_by_role("status")).to_have_text(re.compile(r"^0 of \d+ cells run$"))

    @property
    def bar(self) -> Locator:
        return self.page.get_by_role("region", name="Presentation")

    @property
    def repair(self) -> Locator:
        return self.bar.locator(".ck-stage-repair")

    def run_all(self) -> None:
        """With the key for the next step, as often as it takes."""
        count = self.page.locator(".jp-CodeCell").count()
        for number in range(count):
            expect(self.bar.get_by_role("status")).to_have_text(f"{number} of {count} cells run")
            self.page.keyboard.press("Alt+n")
        expect(self.bar.get_by_role("status")).to_have_text(f"{count} of {count} cells run")

    def outputs(self) -> str:
        return "\n".join(self.page.locator(".jp-OutputArea-output").all_inner_texts())

    def require(self, outcome: str) -> None:
        """The demo says this, once, and no line of it is wider than the page: a projector of 1024 by 768, at first."""
        assert re.findall(r"^It (?:fails|works):", self.outputs(), re.MULTILINE) == [outcome]
        assert self.page.evaluate(TOO_WIDE) == []

    def open_notes(self) -> Page:
        with self.page.expect_popup() as opened:
            self.bar.get_by_role("button", name="Notes").click()
        expect(opened.value.get_by_role("status")).to_be_hidden()
        return opened.value


def take(shown: Page, name: str) -> None:
    ARTIFACTS.mkdir(parents=True, exist_ok=True)
    shown.screenshot(path=ARTIFACTS / f"{name}.png")


def without_findings(shown: Page, within: str) -> None:
    found = Axe().run(shown, context=within).response["violations"]
    assert found == [], [(one["id"], one["nodes"][0]["html"][:200]) for one in found]


@pytest.fixture(scope="module")
def stage(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stage]:
    folder = tmp_path_factory.mktemp("present")
    root = copy_with_notebooks(folder).root
    with served(root, folder, "present") as server, page() as opened:
        opened.set_viewport_size({"width": 1024, "height": 768})
        yield Stage(opened, server.address, server.token)


def test_it_fails_before_the_class_and_one_button_repairs_it(stage: Stage) -> None:
    """And the class sees nothing else of the notebook."""
    stage.open("01_deadlock")
    require_nothing_around(stage)
    expect(stage.repair).to_be_disabled()
    assert "It " not in stage.outputs()
    stage.run_all()
    stage.require("It fails:")
    expect(stage.page.locator(".cm-line.ck-repaired")).to_have_count(0)
    stage.repair.click()
    expect(stage.bar.get_by_role("status")).to_contain_text("cells run, repaired")
    stage.require("It works:")
    expect(stage.page.locator(".cm-line.ck-repaired").first).to_be_in_viewport()
    take(stage.page, "stage_01_deadlock_repaired_1024")


def require_nothing_around(stage: Stage) -> None:
    for around in stage.page.locator(AROUND).all():
        expect(around).to_be_hidden()
    whole = nbformat.read(REPOSITORY / "notebooks/demos/01_deadlock.ipynb", as_version=4)
    spoken = [cell.source for cell in whole.cells if cell.metadata.get("slideshow")]
    assert spoken
    served_text = urllib.request.urlopen(  # noqa: S310 - an http address of this machine
        f"{stage.address}/files/notebooks/demos/01_deadlock.ipynb?token={stage.token}"
    ).read()
    text = stage.page.locator("body").inner_text()
    for remark in (*(source[:30] for source in spoken), "./course present", "Your turn: edit", "lab.stop()"):
        assert remark not in text
        assert remark.encode() not in served_text
    expect(stage.page.locator(".jp-CodeCell .cm-content").first).to_have_css("font-size", "19.968px")


def test_the_notes_follow_the_class_and_lead_it(stage: Stage) -> None:
    asked: list[str] = []
    stage.page.context.on("request", lambda request: asked.append(request.url))
    stage.open("03_silent_parameter")
    cells = preparing.speaker_script(
        nbformat.read(REPOSITORY / "notebooks/demos/03_silent_parameter.ipynb", as_version=4)
    )
    notes = stage.open_notes()
    expect(stage.bar.get_by_role("button", name="Notes")).to_be_hidden()
    shown = notes.locator(".notes:visible")
    expect(notes.get_by_role("heading", level=1)).to_have_text("Demo 3: the parameter that does nothing")
    expect(notes.locator("#planned")).to_have_text("of 4:00")
    code = [cell for cell in cells if cell.kind == "code"]
    said = {cell.cell_id: "".join(cell.notes).split(".")[0].split("`")[0].split("*")[0] for cell in cells}
    for cell in code:
        expect(notes.locator("#next")).to_have_text(cell.label)
        notes.get_by_role("button", name="Run it").click()
        expect(notes.locator("#now")).to_have_text(cell.label)
        if said[cell.cell_id]:
            expect(shown).to_contain_text(said[cell.cell_id])
    expect(notes.locator("#next")).to_contain_text("Put the repair in place")
    stage.require("It fails:")
    notes.locator("#step").click()
    expect(notes.get_by_role("button", name="Undo the repair")).to_be_enabled()
    stage.require("It works:")
    expect(shown).to_contain_text("Reading a parameter is cheap")
    expect(notes.locator("#elapsed")).not_to_have_text("0:00")
    stage.page.locator(".jp-CodeCell .cm-content").first.click()
    expect(notes.locator("#now")).to_have_text(code[0].label)
    hosts = {urlsplit(url).netloc for url in asked if url.startswith(("http", "ws"))}
    assert hosts == {urlsplit(stage.address).netloc}
    notes.close()


def test_the_notes_lead_to_the_next_demo_whose_nodes_are_the_only_ones(stage: Stage) -> None:
    stage.open("05_wrong_name")
    stage.run_all()
    notes = stage.open_notes()
    notes.get_by_role("button", name="Demo 6").click()
    expect(notes.get_by_role("heading", level=1)).to_contain_text("Demo 6")
    expect(stage.bar.get_by_role("status")).to_have_text(re.compile("^0 of"))
    assert stage.page.url.endswith("06_late_result.ipynb")
    stage.run_all()
    notes.get_by_role("button", name="Start this demo again").click()
    expect(stage.bar.get_by_role("status")).to_have_text(re.compile("^0 of"))
    running = f"{stage.address}/api/sessions?token={stage.token}"
    wait_until(lambda: opened_notebooks(running) == ["06_late_result.ipynb"], lambda: opened_notebooks(running))
    notes.close()


def test_both_windows_can_be_read_at_any_size_and_a_repair_can_be_taken_back(stage: Stage) -> None:
    """Readable before a demo is run, and repaired. A page that is loaded again begins afresh, though the kernel still
    runs, with the repaired class in it. Closing it asks nothing; without a page for the class, the notes say so.
    """
    stage.open("04_float_or_int")
    notes = stage.open_notes()
    for size in SIZES:
        require_readable(stage, notes, "opened", size)
    stage.run_all()
    expect(notes.get_by_role("button", name="Repair")).to_be_enabled()
    stage.page.keyboard.press("Alt+r")
    expect(stage.repair).to_have_text("Undo the repair")
    expect(stage.repair).to_be_enabled()
    expect(notes.get_by_role("button", name="Undo the repair")).to_be_enabled()
    for size in SIZES:
        require_readable(stage, notes, "repaired", size)
    stage.repair.click()
    expect(stage.repair).to_have_text("Repair")
    expect(stage.repair).to_be_enabled()
    stage.require("It fails:")
    stage.repair.click()
    expect(stage.repair).to_have_text("Undo the repair")
    stage.page.reload()
    expect(stage.bar.get_by_role("status")).to_have_text(re.compile("^0 of"))
    stage.run_all()
    expect(stage.page.locator(".jp-CodeCell .jp-InputPrompt").first).to_have_text("[1]:")
    stage.require("It fails:")
    asked: list[str] = []
    stage.page.once("dialog", lambda dialog: (asked.append(dialog.message), dialog.accept()))
    stage.page.goto("about:blank")
    assert asked == []
    expect(notes.get_by_role("status")).to_contain_text("Waiting for the page that the class sees")
    expect(notes.get_by_role("button", name="Start this demo again")).to_be_disabled()
    without_findings(notes, "body")
    notes.close()


def require_readable(stage: Stage, notes: Page, state: str, size: tuple[int, int, str]) -> None:
    width, height, scheme = size
    for shown in (stage.page, notes):
        shown.set_viewport_size({"width": width, "height": height})
        shown.emulate_media(color_scheme=scheme)  # type: ignore[arg-type]
    expect(stage.page.locator("body")).to_have_attribute("data-jp-theme-light", str(scheme == "light").lower())
    without_findings(notes, "body")
    without_findings(stage.page, "#ck-stage-bar")
    take(stage.page, f"stage_{state}_{width}_{scheme}")
    take(notes, f"stage_notes_{state}_{width}_{scheme}")
    assert stage.page.evaluate(TOO_WIDE) == []
    assert notes.evaluate("document.documentElement.scrollWidth <= innerWidth")
    ground = stage.page.locator(".jp-Notebook").evaluate("one => getComputedStyle(one).backgroundColor")
    assert (int(re.findall(r"\d+", ground)[0]) < 128) == (scheme == "dark")


def test_the_notes_are_for_whoever_has_the_token(stage: Stage) -> None:
    address = f"{stage.address}/course-kit/speaker"
    with urllib.request.urlopen(f"{address}?token={stage.token}") as answer:  # noqa: S310 - of this machine
        assert b"Keep the answer to yourself" in answer.read()
    with urllib.request.urlopen(address) as answer:  # noqa: S310 - of this machine
        assert "/login" in answer.url
        assert b"Keep the answer to yourself" not in answer.read()
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(f"{stage.address}/api/sessions")  # noqa: S310 - of this machine


def opened_notebooks(address: str) -> list[str]:
    with urllib.request.urlopen(address) as answer:  # noqa: S310 - an http address of this machine
        return [session["name"] for session in json.load(answer)]

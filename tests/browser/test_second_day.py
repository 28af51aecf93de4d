"""A notebook that is opened again: what its panels show when their kernel goes on, ends, or is another one."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.learner import POLLING_MS

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

    from tests.browser.learner import JupyterLab, OpenServer

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]
LESSON = "notebooks/00_welcome.ipynb"
GRAPH = "graph = panels.graph()"
# Whether the notebook holds the graph as it is now, for the next day.
KEPT = """() => [...window.jupyterapp.shell.currentWidget.model.cells].some(cell => cell.type === 'code' &&
    cell.sharedModel.getOutputs().some(output => output.data?.['text/html']?.includes('data-node="battery"')))"""
# Whether what anywidget waits with for a panel is over after its own two seconds.
HURRIES = """() => new Promise(tell => {
    const anywidget = AbortSignal.timeout(2000);
    AbortSignal.timeout(2100).addEventListener('abort', () => tell(anywidget.aborted));
})"""
# A panel that JupyterLab has not got from a slow kernel.
FORGET = """async panel => {
    const shown = panel.closest('.jp-OutputArea-output');
    const cells = window.jupyterapp.shell.currentWidget.content.widgets;
    const { model, widgets } = cells.find(({ node }) => node.contains(panel)).outputArea;
    const manager = await [...widgets[0].widgets].find(({ node }) => node === shown)._manager.promise;
    const { model_id } = model.get(0).data['application/vnd.jupyter.widget-view+json'];
    delete manager._models[model_id];
    manager.kernel._comms.delete(model_id);
    shown.textContent = 'Error displaying widget: model not found';
}"""
HAS_ROOM = "one => one.scrollWidth <= one.clientWidth && one.scrollHeight <= one.clientHeight"
WAKE = "Run the cells down to this panel to bring it to life"


def open_again(lab: JupyterLab) -> None:
    lab.page.goto(f"{lab.address}/lab/tree/{LESSON}?token={lab.token}")
    expect(lab.page.locator("#jp-main-statusbar")).to_contain_text("| Idle")


def choose_of_kernel_menu(page: Page, name: str) -> None:
    page.get_by_role("menuitem", name="Kernel", exact=True).click()
    page.get_by_role("menuitem", name=re.compile(f"^{name}")).first.click()


def require_no_dead_widget(lab: JupyterLab) -> None:
    """No words of the widgets' own about a model that is gone but behind a picture; the docked view has its name."""
    expect(lab.page.get_by_role("tab", name="ROS graph")).to_be_visible()
    for words in ("Loading widget", "Error displaying widget"):
        assert not [one for one in lab.page.get_by_text(words).all() if one.is_visible()], words


def require_map_found_later(lab: JupyterLab) -> None:
    lab.scroll_to(lab.page.locator(".ck-map")).evaluate(FORGET)
    expect(lab.scroll_to(lab.page.locator(".ck-map")).get_by_label("x (m)")).to_have_value("0.5")


def require_docked(lab: JupyterLab, graph: Locator, docked: Locator) -> None:
    """The keyboard goes on in the notebook, below the panel's cell, and a second click docks nothing again."""
    expect(docked.get_by_text("The ROS graph", exact=True)).to_be_visible()
    expect(docked.get_by_role("button", name="Dock beside the notebook")).to_have_count(0)
    notebook = lab.page.locator(".jp-NotebookPanel").bounding_box()
    beside = docked.bounding_box()
    assert notebook is not None
    assert beside is not None
    assert beside["x"] >= notebook["x"] + notebook["width"]
    below = lab.page.locator(".jp-Cell:has(.ck-graph) + .jp-Cell")
    expect(below).to_have_class(re.compile("jp-mod-active"))
    for _ in range(2):
        lab.page.keyboard.press("Shift+Enter")
    expect(below).not_to_have_class(re.compile("jp-mod-active"))
    graph.get_by_role("button", name="Dock beside the notebook").click()
    expect(lab.page.locator(".lm-TabBar-tabLabel", has_text="ROS graph")).to_have_count(1)


def require_room(docked: Locator) -> None:
    """What the notebook hears and what it sends is drawn, and none of it is cut off."""
    for verb in ("listens to", "sends goals to"):
        expect(docked.locator(f"[data-of=lab][data-verb='{verb}']").first).to_be_attached()
    expect(docked.get_by_text("Dashed arrow: the node listens")).to_be_visible()
    docked.page.set_viewport_size({"width": 1366, "height": 300})  # what is around it scrolls, and only that
    assert docked.locator(".ck-picture").evaluate(HAS_ROOM)
    docked.page.set_viewport_size({"width": 1366, "height": 1000})


def drive_and_guess(lab: JupyterLab) -> None:
    arena = lab.scroll_to(lab.page.locator(".ck-map"))
    arena.get_by_label("x (m)").fill("0.5")
    arena.get_by_label("x (m)").press("Enter")
    expect(arena).to_contain_text("The goal (0.5, 2.0) has succeeded")
    question = lab.scroll_to(lab.page.locator("form:has(.ck-guess-send)"))
    question.locator("input[type=radio]").first.check()
    question.locator(".ck-guess-send").click()
    expect(question.locator(".ck-guess-verdict")).not_to_be_empty()


def wake_below(lab: JupyterLab, docked: Locator) -> None:
    """Wake a second panel: the cells above it run first, but no %check, all in this notebook."""
    below = lab.scroll_to(lab.cell_that_begins('panels.guess("00_welcome/misspelt_stop")'))
    lab.page.evaluate("window.ran = []; jupyterapp.commands.commandExecuted.connect((_, { args }) => ran.push(args))")
    below.get_by_role("button", name=WAKE).click()
    expect(docked.locator("[data-node='dashboard']").first).to_be_visible()
    expect(lab.scroll_to(lab.cell_that_begins(GRAPH)).locator(".jp-InputPrompt").first).to_have_text("[4]:")
    assert lab.page.evaluate("ran.some(({ semanticCommandWidgetId }) => semanticCommandWidgetId)")


def require_end_at_a_failure(lab: JupyterLab) -> None:
    """A cell that fails ends the run; the panel keeps its picture and says which cell that was."""
    lab.scroll_to(lab.cell_that_begins('lab.stop("battery")'))
    lab.replace_cell_that_begins('lab.stop("battery")', "1 / 0")
    below = lab.scroll_to(lab.cell_that_begins('panels.guess("00_welcome/misspelt_stop")'))
    below.get_by_role("button", name=WAKE).click()
    expect(below).to_contain_text(re.compile(r"The cell \[\d+\] above has failed\. Repair it, then press again\."))
    lab.replace_cell_that_begins("1 / 0", "lab.nodes()  # repaired")


def require_two_columns(lab: JupyterLab) -> None:
    """Another graph that is docked stands where the first one does."""
    lab.scroll_to(lab.cell_that_begins("# You may send it from here"))
    lab.replace_cell_that_begins("# You may send it from here", "panels.graph()  # again")
    lab.page.keyboard.press("Control+Enter")
    again = lab.cell_that_begins("panels.graph()  # again")
    again.get_by_role("button", name="Dock beside the notebook").click()
    expect(lab.page.locator(".lm-TabBar-tabLabel", has_text="ROS graph")).to_have_count(2)
    expect(lab.page.locator(".lm-TabBar-content", has_text="ROS graph")).to_have_count(1)


def restart_then_shut_down(lab: JupyterLab, docked: Locator) -> None:
    choose_of_kernel_menu(lab.page, "Restart Kernel…")
    lab.page.get_by_role("button", name="Confirm Kernel Restart").click()
    for place in (lab.scroll_to(lab.cell_that_begins(GRAPH)), docked):
        expect(place.get_by_role("button", name=WAKE)).to_be_visible()
        expect(place.locator("svg").get_by_text("battery", exact=True).filter(visible=True).first).to_be_visible()
        # Nothing in it can be pressed: it is the panel itself, or, where JupyterLab was first, its stored picture.
        expect(place.locator("[inert], .ck-still").first).to_be_attached()
    docked.get_by_role("button", name=WAKE).click()
    expect(docked.get_by_text("The ROS graph", exact=True)).to_be_visible()
    lab.wait_until_run()
    choose_of_kernel_menu(lab.page, "Shut Down Kernel")
    expect(lab.page.locator("#jp-main-statusbar")).to_contain_text("No Kernel")
    wake_below(lab, docked)
    lab.wait_until_run()


def test_a_panel_survives_a_reload_a_restart_and_the_night(lab: JupyterLab, jupyter: OpenServer) -> None:
    page = lab.page
    page.set_viewport_size({"width": 1366, "height": 1000})
    lab.open(LESSON)
    assert page.evaluate(HURRIES) is False  # a panel of a busy machine is given its time
    lab.run_all()
    graph = lab.scroll_to(lab.cell_that_begins(GRAPH))
    graph.get_by_role("button", name="Dock beside the notebook").click()
    docked = page.locator(".jp-LinkedOutputView")
    require_docked(lab, graph, docked)
    lab.run_cell_that_begins("from rclpy.node import Node")
    expect(docked.locator("[data-node='battery']").first).to_be_visible()
    expect(docked.locator(".ck-dot").first).to_be_attached()
    lab.picture("graph_docked")
    drive_and_guess(lab)
    require_room(docked)
    page.wait_for_function(KEPT, polling=POLLING_MS)
    lab.save()

    open_again(lab)  # the kernel goes on
    expect(docked.get_by_text("The ROS graph", exact=True)).to_be_visible()
    graph = lab.scroll_to(lab.cell_that_begins(GRAPH))
    graph.get_by_role("button", name="Dock beside the notebook").click()
    expect(graph.get_by_role("button", name="Dock beside the notebook")).to_be_visible()
    expect(docked).to_have_count(1)
    expect(page.get_by_role("button", name=WAKE)).to_have_count(0)
    require_no_dead_widget(lab)
    require_map_found_later(lab)

    restart_then_shut_down(lab, docked)
    expect(page.locator("#jp-main-statusbar")).to_contain_text("| Idle")
    jupyter.server.end_kernels()
    with page.expect_request("**/course-kit/guesses") as asked:
        open_again(lab)  # another day, another kernel
        guess = lab.scroll_to(page.locator(".ck-asleep-chosen"))
    assert asked.value.headers["x-xsrftoken"]  # JupyterHub refuses it without
    expect(guess).to_contain_text("(your guess)")
    graph = lab.scroll_to(lab.cell_that_begins(GRAPH))
    for place in (graph, docked):
        expect(place.get_by_role("button", name=WAKE)).to_be_visible()
        # The last picture, not the first.
        expect(place.locator("svg").get_by_text("battery", exact=True)).to_be_visible()
    require_no_dead_widget(lab)
    lab.picture("second_day")
    graph.get_by_role("button", name=WAKE).click()
    expect(page.get_by_text("The ROS graph", exact=True)).to_have_count(2)
    expect(graph.get_by_role("button", name=WAKE)).to_have_count(0)
    require_end_at_a_failure(lab)
    wake_below(lab, docked)
    require_two_columns(lab)

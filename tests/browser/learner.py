"""A learner: `./course lab` in a real Chromium, and the things one does there."""

from __future__ import annotations

import json
import re
import shutil
import time
from contextlib import contextmanager, nullcontext, suppress
from typing import TYPE_CHECKING

from playwright.sync_api import Browser, Locator, Page, expect, sync_playwright

from course_kit import environment
from course_kit.dev import suite
from tests import jupyter_server
from tests.course_copy import REPOSITORY, copy_with_notebooks

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ARTIFACTS = REPOSITORY / "artifacts" / "screenshots"
CHROMIUM_FLAGS = [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]
# Notebook 7 trips over its own settings when it starts, with any notebook, and after a JupyterLab over a file browser
# that it has not; panels' code comes from a blob: address.
NOTEBOOK_7_ITSELF = (
    r"(?:\(reading 'schema'\)|'filebrowser:open-path' not registered)[\s\S]*?\n"
    r"(?:(?!blob:)[\s\S])*/static/notebook/notebook_core"
)
# JupyterLab's debugger and subshells ask a kernel that has just been restarted or ended.
KERNEL_ENDED = r"Canceled future for \w+ message before replies were done|widget model not found"
PATIENCE_MS = 240_000  # against hanging only
SAVED_MS = 15_000  # much longer than saving takes
POLLING_MS = 100  # Playwright itself asks at each frame, which has a page that waits draw frames
ROLL = """panel => {
    const isAtEnd = panel.scrollTop + panel.clientHeight >= panel.scrollHeight - 1;
    panel.scrollTo(0, isAtEnd ? 0 : panel.scrollTop + panel.clientHeight / 2);
}"""
SETTINGS = {
    "@jupyterlab/docmanager-extension/plugin.jupyterlab-settings": {"autosave": False},
    "@jupyterlab/apputils-extension/notification.jupyterlab-settings": {"fetchNews": "false", "checkForUpdates": False},
}


class JupyterLab:
    """Verbs of a learner in JupyterLab.

    Attributes:
        root: the folder that it shows; for `./course lab` the learner's, in the course's own.
    """

    def __init__(self, page: Page, root: Path, address: str, token: str) -> None:
        self.page, self.root, self.address, self.token = page, root, address, token

    def open(self, notebook: str) -> None:
        self.page.goto(f"{self.address}/lab/tree/{notebook}?token={self.token}&reset")
        # The circle is empty and the status bar says Idle only when the kernel is connected.
        expect(self.page.locator("#jp-main-statusbar")).to_contain_text("| Idle")
        expect(self.page.locator(".jp-Notebook-ExecutionIndicator[data-status='idle']")).to_be_attached()

    def open_in_notebook_7(self, notebook: str) -> None:
        """Open it in Jupyter's other face; the same server has both."""
        self.page.goto(f"{self.address}/notebooks/{notebook}?token={self.token}")
        # The circle is empty before there is a kernel, too; its status fades away only when it is connected and idle.
        status = ".jp-NotebookKernelStatus-fade:not(.jp-NotebookKernelStatus-info)"
        expect(self.page.locator(status)).to_be_attached()
        expect(self.page.locator(".jp-Notebook-ExecutionIndicator[data-status='idle']")).to_be_attached()

    def run_all(self) -> None:
        self.page.get_by_role("menuitem", name="Run", exact=True).click()
        self.page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        self.wait_until_run()

    def wait_until_run(self) -> None:
        """Until no cell shows the star of a cell that waits or runs, and the kernel is idle."""
        self.page.wait_for_function(
            """() => {
                const prompts = [...document.querySelectorAll('.jp-CodeCell .jp-InputPrompt')].map(p => p.textContent);
                const ran = prompts.filter(p => /\\[\\d+\\]/.test(p)).length;
                const idle = document.querySelector(".jp-Notebook-ExecutionIndicator[data-status='idle']");
                return ran > 0 && idle && !prompts.some(p => p.includes('*'));
            }""",
            polling=POLLING_MS,
        )

    def scroll_to(self, wanted: Locator) -> Locator:
        """Roll the wheel down, and on from the top, until it is there: JupyterLab draws what comes near, no more."""
        notebook = self.page.locator(".jp-Notebook .jp-WindowedPanel-outer").first
        deadline = time.monotonic() + PATIENCE_MS / 1000
        while not wanted.count():
            assert time.monotonic() < deadline, f"{wanted} is nowhere in the notebook"
            notebook.evaluate(ROLL)
            self.page.wait_for_timeout(50)
        wanted.first.scroll_into_view_if_needed()
        return wanted.first

    def cell_that_begins(self, start: str) -> Locator:
        """The code cells with these words in their code; what a cell shows below it does not count."""
        return self.page.locator(".jp-CodeCell", has=self.page.locator(".cm-content", has_text=start))

    def run_cell_that_begins(self, start: str) -> None:
        cell = self.scroll_to(self.cell_that_begins(start))
        prompt = cell.locator(".jp-InputPrompt").first
        before = prompt.inner_text()
        cell.locator(".cm-content").click()
        self.page.keyboard.press("Control+Enter")
        expect(prompt).not_to_have_text(before)
        expect(prompt).to_have_text(re.compile(r"\[\d+\]"))

    def replace_cell_that_begins(self, start: str, text: str) -> None:
        cell = self.cell_that_begins(start).first
        cell.scroll_into_view_if_needed()
        cell.locator(".cm-content").click()
        self.page.keyboard.press("Control+A")
        self.page.keyboard.insert_text(text)

    def save(self) -> None:
        """Save, and again where a panel has had its picture kept since."""
        for patience_ms in (SAVED_MS, SAVED_MS, None):
            self.page.get_by_role("menuitem", name="File", exact=True).click()
            self.page.get_by_role("menuitem", name=re.compile(r"^Save Notebook(?! As)")).first.click()
            with suppress(AssertionError) if patience_ms else nullcontext():
                expect(self.page.locator(".jp-mod-dirty")).to_have_count(0, timeout=patience_ms)
                return

    def require_no_error(self, notebook: str) -> None:
        """Save, and look for errors in the file: JupyterLab keeps outputs that are far off out of the page."""
        self.save()
        saved = json.loads((self.root / notebook).read_text())
        code = [cell for cell in saved["cells"] if cell["cell_type"] == "code"]
        unasked = [cell for cell in code if "raises-exception" not in cell["metadata"].get("tags", [])]
        failed = [one["evalue"] for cell in unasked for one in cell["outputs"] if one["output_type"] == "error"]
        assert code
        assert not failed, failed

    def picture(self, name: str) -> Path:
        ARTIFACTS.mkdir(parents=True, exist_ok=True)
        path = ARTIFACTS / f"{name}.png"
        self.page.screenshot(path=path)
        return path


class CourseServer:
    """A JupyterLab on a copy of the course, which can be had again as on the first day.

    Attributes:
        root: the learner's folder in the copy.
        api: the server itself.
    """

    def __init__(self, root: Path, api: jupyter_server.Server) -> None:
        self.root, self.api = root / environment.LEARNER_FOLDER, api
        self._settings, self._first_day = root.parent / "settings", root.parent / "first day"
        shutil.copytree(self.root, self._first_day, symlinks=True)

    def begin_anew(self) -> None:
        """Have the folder, what was reached and JupyterLab's settings as on the first day."""
        for left in self.root.iterdir():
            shutil.rmtree(left) if left.is_dir() and not left.is_symlink() else left.unlink()
        shutil.copytree(self._first_day, self.root, symlinks=True, dirs_exist_ok=True)
        kept = self.root.parent / ".course"
        (kept / "progress.json").unlink(missing_ok=True)
        shutil.rmtree(kept / "guesses", ignore_errors=True)
        write_settings(self._settings)
        shutil.rmtree(self._settings.parent / "workspaces", ignore_errors=True)

    def end_kernels(self) -> None:
        """End all kernels, as closing JupyterLab does."""
        for session in self.api.get("sessions"):
            self.api.delete(f"sessions/{session['id']}")


class OpenServer:
    """A JupyterLab and a Chromium, for one learner after the other."""

    def __init__(self, server: CourseServer, chromium: Browser) -> None:
        self.server, self.chromium = server, chromium

    @contextmanager
    def learner(self) -> Iterator[JupyterLab]:
        """Somebody new: the folder, JupyterLab's settings and the browser are as on the first day."""
        self.server.begin_anew()
        api = self.server.api
        try:
            with page(self.chromium) as opened:
                yield JupyterLab(opened, self.server.root, api.address, api.token)
        finally:
            self.server.end_kernels()


@contextmanager
def started_server(folder: Path) -> Iterator[CourseServer]:
    """JupyterLab on a copy of the course."""
    root = copy_with_notebooks(folder).root
    with served(root, folder, "lab", COURSE_KIT_PROGRESS="") as server:  # progress is kept in the learner's folder
        yield CourseServer(root, server)


@contextmanager
def served(root: Path, folder: Path, verb: str, **changes: str | None) -> Iterator[jupyter_server.Server]:
    """Start `./course lab`, or `present`, and end it as closing the terminal does."""
    write_settings(folder / "settings")
    with environment.exclusive_domain() as domain_id:
        variables = environment.child_environment(
            PYTHONPATH=str(root),  # the environment knows the course by its first folder
            ROS_DOMAIN_ID=str(domain_id),
            JUPYTERLAB_SETTINGS_DIR=str(folder / "settings"),
            JUPYTERLAB_WORKSPACES_DIR=str(folder / "workspaces"),
            JUPYTER_RUNTIME_DIR=str(folder / "runtime"),
            XDG_STATE_HOME=str(folder / "state"),
        )
        with jupyter_server.started(
            [root / "course", verb, *jupyter_server.allow_root()], folder, root, {**variables, **changes}
        ) as server:
            yield server


def write_settings(folder: Path) -> None:
    """JupyterLab's settings as a test has them."""
    shutil.rmtree(folder, ignore_errors=True)
    for name, values in SETTINGS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(json.dumps(values))


@contextmanager
def chromium() -> Iterator[Browser]:
    """A new Chromium."""
    with sync_playwright() as playwright:
        # Scroll bars take room, as they do for learners; a test's browser hides them.
        shown = {"args": CHROMIUM_FLAGS, "ignore_default_args": ["--hide-scrollbars"]}
        started = playwright.chromium.launch(executable_path=suite.find_browser(), **shown)
        yield started
        started.close()


@contextmanager
def page(within: Browser | None = None) -> Iterator[Page]:
    """A page that fails the test when the page's own code fails; of a Chromium of its own, if none is given."""
    errors: list[str] = []
    with nullcontext(within) if within else chromium() as started:
        context = started.new_context(viewport={"width": 1280, "height": 1000})
        opened = context.new_page()
        opened.set_default_timeout(PATIENCE_MS)
        expect.set_options(timeout=PATIENCE_MS)
        opened.on("pageerror", lambda error: errors.append(f"{error}\n{error.stack}"))
        opened.on("console", lambda said: said.type == "error" and errors.append(f"{said.text} {said.location['url']}"))
        yield opened
        context.close()
    ours = [error for error in errors if not re.search(f"{NOTEBOOK_7_ITSELF}|{KERNEL_ENDED}", error)]
    assert not ours, "\n".join(ours)

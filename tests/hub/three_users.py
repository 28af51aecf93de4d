"""The course on a real JupyterHub: three Unix users in Chromium, each in lesson 1 at once, and none meets another.

`uvx nox --sessions hub` runs it, as root: it makes users, installs the course anew and takes some minutes, so it is not
among the tests that pytest collects by itself.
"""

from __future__ import annotations

import re
import subprocess
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

import pytest
from playwright.sync_api import expect

from course_kit import environment
from course_kit.integrations.jupyter import FIRST_LESSON
from tests.browser.learner import JupyterLab, chromium, page, whole
from tests.course_copy import TEMPERATURE
from tests.hub import machine
from tests.unprivileged import reachable_folder
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from playwright.sync_api import Browser

    from tests.hub.machine import Account, Hub

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

LESSON_1 = "notebooks/01_services.ipynb"
USERS = 3
MOST_KB = 4096  # a home directory after lesson 1
TABLE = environment.PACKAGE.parent / "artifacts" / "jupyterhub.md"


class Machine:
    """What all tests share."""

    def __init__(self, folder: Path, course: Path, users: list[Account], hub: Hub, browser: Browser) -> None:
        self.folder, self.course, self.users, self.hub, self.browser = folder, course, users, hub, browser

    @contextmanager
    def at_work(self, *users: Account, first: str | None = None) -> Iterator[list[JupyterLab]]:
        """Users who have logged in, each with a browser of their own and the first page before them."""
        with ExitStack() as stack:
            labs = []
            for user in users:
                opened = stack.enter_context(page(self.browser))
                opened.goto(f"{self.hub.address}{first or '/hub/login'}")
                opened.locator("#username_input").fill(user.name)
                opened.locator("#password_input").fill(machine.PASSWORD)
                opened.locator("#login_submit").click()
                address = f"{self.hub.address}/user/{user.name}"
                labs.append(JupyterLab(opened, user.home / "ros2-course", address, ""))
            yield labs


@pytest.fixture(scope="module")
def here() -> Iterator[Machine]:
    with reachable_folder() as folder, machine.accounts(folder, USERS) as users:
        course = machine.install(folder)
        with machine.hub(folder, course) as hub, chromium() as browser:
            yield Machine(folder, course, users, hub, browser)


def printed(lab: JupyterLab, cell: str) -> str:
    """What a cell of lesson 1 has printed, from the file."""
    read: list[dict[str, Any] | None] = []
    # JupyterLab may be saving it right now.
    wait_until(lambda: read.append(whole(lab.root / LESSON_1)) or read[-1], f"a whole {LESSON_1}")
    found = next(one for one in (read[-1] or {})["cells"] if cell in "".join(one["source"]))
    return "".join("".join(output.get("text", "")) for output in found["outputs"])


def run_instead(lab: JupyterLab, before: str, code: str) -> None:
    """Put other code into a cell, and run it."""
    lab.replace_cell_that_begins(before, code)
    lab.run_cell_that_begins(code.splitlines()[0])


def test_three_users_work_at_once_each_with_files_and_nodes_of_their_own(here: Machine) -> None:
    with here.at_work(*here.users) as labs:
        for lab in labs:
            expect(lab.page).to_have_url(f"{lab.address}/lab/tree/{FIRST_LESSON}")
            expect(lab.page.locator("#jp-main-statusbar")).to_contain_text("| Idle")
        for lab in labs:
            lab.page.goto(f"{lab.address}/lab/tree/{LESSON_1}?reset")
        for lab in labs:
            lab.open(LESSON_1)
            lab.page.get_by_role("menuitem", name="Run", exact=True).click()
            lab.page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
        for lab in labs:
            lab.wait_until_run()
        for user, lab in zip(here.users, labs, strict=True):
            name = user.name.replace("-", "_")
            code = f'lab.stop_script(); lab.stop(); lab.start(Node, "{name}")'
            run_instead(lab, "%load_ext course_kit", code)
        for user, lab in zip(here.users, labs, strict=True):
            name = user.name.replace("-", "_")
            run_instead(lab, "lab.stop_script()", "!ros2 node list\n!echo domain $ROS_DOMAIN_ID")
            lab.picture(f"hub_{user.name}")
            lab.require_no_error(LESSON_1)
        said = [printed(lab, "!ros2 node list").split() for lab in labs]
        assert [words[0] for words in said] == [f"/{user.name}".replace("-", "_") for user in here.users]
        assert [words[1] for words in said] == ["domain"] * USERS, "there is another node"
        assert len({words[2] for words in said}) == USERS
        write_table(here)
    for user in here.users:
        assert user.disk_kb() < MOST_KB
        assert all(path.owner() == user.name for path in user.home.rglob("*") if not path.is_symlink())


def write_table(here: Machine) -> None:
    """What the users cost, for people."""
    installed = subprocess.run(["du", "-sm", here.course], capture_output=True, text=True, check=True)
    rows = [f"| {user.name} | {user.disk_kb() / 1024:.1f} | {user.memory_mb():.0f} |" for user in here.users]
    head = ["| user, with lesson 1 open | disk, MB | memory, MB |", "|---|---|---|"]
    once = f"One installation: {installed.stdout.split()[0]} MB."
    environment.write_atomically(TABLE, "\n".join([*head, *rows, "", once, ""]), durable=False)


def test_below_a_base_url_panels_dock_links_land_and_grades_show(here: Machine) -> None:
    with here.at_work(here.users[0]) as (lab,):
        lab.open(FIRST_LESSON)
        for start in ("%load_ext course_kit", "graph = panels.graph()"):
            lab.run_cell_that_begins(start)
        lab.scroll_to(lab.page.locator(".ck-graph")).get_by_role("button", name="Dock beside the notebook").click()
        expect(lab.page.locator(".jp-LinkedOutputView .ck-graph")).to_be_visible()
        lab.picture("hub_docked")
        lab.open(LESSON_1)
        lab.page.get_by_role("link", name="glossary").first.click()
        expect(lab.page.locator('[data-jupyter-id="Glossary"], [id="Glossary"]').first).to_be_in_viewport()
        lab.open(f"exercises/{TEMPERATURE}/{TEMPERATURE}.ipynb")
        lab.run_all()
        expect(lab.scroll_to(lab.page.get_by_text(re.compile("of 10 points")))).to_be_visible()
        lab.picture("hub_grade")


def test_a_link_of_nbgitpuller_brings_a_notebook_that_uses_the_course(here: Machine) -> None:
    user = here.users[1]
    with served_repository(here) as repository:
        link = f"/hub/user-redirect/git-pull?repo={repository}&branch=main&urlpath=lab/tree/own/{TEMPERATURE}.ipynb"
        with here.at_work(user, first=link) as (lab,):
            expect(lab.page).to_have_url(f"{lab.address}/lab/tree/own/{TEMPERATURE}.ipynb")
            expect(lab.page.locator("#jp-main-statusbar")).to_contain_text("| Idle")
            lab.open(f"own/{TEMPERATURE}.ipynb")  # without the lesson that was open before
            lab.run_all()
            expect(lab.scroll_to(lab.page.get_by_text(re.compile("of 10 points")))).to_be_visible()
    assert (user.home / "ros2-course" / "own" / f"{TEMPERATURE}.ipynb").is_file()


@contextmanager
def served_repository(here: Machine) -> Iterator[str]:
    """An instructor's repository with one notebook, served by git itself."""
    folder = here.folder / "git"
    work = folder / "own"
    work.mkdir(parents=True)
    (work / f"{TEMPERATURE}.ipynb").write_bytes(
        (here.course / "exercises" / TEMPERATURE / f"{TEMPERATURE}.ipynb").read_bytes()
    )
    git = ["git", "-c", "user.name=Instructor", "-c", "user.email=instructor@example.org", "-C", str(work)]
    for arguments in (["init", "-q", "-b", "main"], ["add", "."], ["commit", "-q", "-m", "A notebook"]):
        subprocess.run([*git, *arguments], check=True)
    port = machine.free_ports(1)[0]
    daemon = ["git", "daemon", "--export-all", "--listen=127.0.0.1", f"--port={port}", f"--base-path={folder}"]
    address = f"git://127.0.0.1:{port}/own"
    with subprocess.Popen([*daemon, str(folder)], stderr=subprocess.DEVNULL, start_new_session=True) as serving:
        try:
            asking = ["git", "ls-remote", address]
            wait_until(lambda: subprocess.run(asking, capture_output=True, check=False).returncode == 0, "git daemon")
            yield address
        finally:
            serving.terminate()


def test_a_server_that_is_stopped_takes_its_kernels_and_nodes_along(here: Machine) -> None:
    user = here.users[2]
    with here.at_work(user) as (lab,):
        expect(lab.page.locator("#jp-main-statusbar")).to_contain_text("| Idle")
        lab.page.goto("about:blank")  # it would say that the server has gone
    assert any("ipykernel_launcher" in " ".join(process.cmdline()) for process in user.processes())
    here.hub.stop_server(user.name)
    wait_until(lambda: not user.processes(), lambda: [process.cmdline() for process in user.processes()])

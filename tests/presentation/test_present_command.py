"""`present` from the first word to the last: what it says, what it shares with nobody, and what it leaves behind."""

from __future__ import annotations

import shutil
import socket
import subprocess
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest

from tests.course_copy import Course, copy_with_notebooks
from tests.jupyter_server import allow_root, started
from tests.waiting import wait_until

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from tests.jupyter_server import Server

pytestmark = pytest.mark.timeout(600)
OWN = ("ROS_DOMAIN_ID", "COURSE_KIT_DOMAIN_ID")


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Course:
    """In a folder whose name has a space."""
    return copy_with_notebooks(tmp_path_factory.mktemp("of a lecturer"))


def environ(course: Course, folder: Path, **changes: str) -> dict[str, str]:
    (folder / "temporary").mkdir(exist_ok=True)
    own = {**changes, "TMPDIR": str(folder / "temporary")}
    return {name: value for name, value in course.environ(**own).items() if name not in OWN or name in changes}


def scratch(folder: Path) -> list[Path]:
    return list((folder / "temporary").glob("course-present-*"))


def refused(course: Course, folder: Path, *words: str, **changes: str) -> str:
    done = subprocess.run(
        course.command("present", *words), cwd=course.root, env=environ(course, folder, **changes),
        stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300, check=False,
    )  # fmt: skip
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.strip().splitlines()) == 1, done.stderr
    assert scratch(folder) == []
    return done.stderr


@contextmanager
def presented(course: Course, folder: Path, *words: str) -> Iterator[Server]:
    folder.mkdir(exist_ok=True)
    command = course.command("present", *words, *allow_root())
    with started(command, folder, course.root, environ(course, folder)) as server:
        yield server


def test_what_cannot_be_shown_is_told_in_one_sentence(course: Course, tmp_path: Path) -> None:
    assert "Did you mean 01_deadlock?" in refused(course, tmp_path, "dedlock")
    assert "Name one of them" in refused(course, tmp_path, "deadlock", "lost_cancel", "--no-browser")
    assert "'300'" in refused(course, tmp_path, "--no-browser", ROS_DOMAIN_ID="300")


def test_a_course_without_demos_or_with_a_damaged_one_says_so(tmp_path: Path) -> None:
    course = copy_with_notebooks(tmp_path)
    demos = course.root / "notebooks" / "demos"
    (demos / "02_lost_cancel.ipynb").write_text("{")
    assert "02_lost_cancel.ipynb is damaged" in refused(course, tmp_path, "cancel")
    shutil.rmtree(demos)
    assert "There are no demos in" in refused(course, tmp_path)


def test_it_opens_the_demo_that_was_named_and_leaves_the_courses_own_file_alone(course: Course, tmp_path: Path) -> None:
    own = course.root / "notebooks/demos/02_lost_cancel.ipynb"
    before = own.read_bytes()
    with presented(course, tmp_path, "cancel") as server:
        wait_until(lambda: "your notes are" in server.log.read_text(), server.log.read_text)
        said = server.log.read_text()
        assert f"{server.address.replace('127.0.0.1', 'localhost')}/doc/tree/notebooks/demos/02_lost_cancel" in said
        assert "Traceback" not in said
        copied = server.get("contents/notebooks/demos/02_lost_cancel.ipynb")
        assert copied["writable"] is True
        assert "CancelResponse.ACCEPT" not in "".join(cell["source"] for cell in copied["content"]["cells"])
        assert len(scratch(tmp_path)) == 1
        assert oct(scratch(tmp_path)[0].stat().st_mode & 0o777) == "0o700"
    assert own.read_bytes() == before
    assert scratch(tmp_path) == []
    with socket.create_server(("127.0.0.1", int(server.address.rpartition(":")[2]))):
        pass  # nobody has its port any more


def test_two_at_a_time_share_neither_port_nor_domain_nor_copies(course: Course, tmp_path: Path) -> None:
    def domain_of(server: Server) -> str:
        return server.in_terminal("echo $ROS_DOMAIN_ID")

    with presented(course, tmp_path, "1") as first:
        (mine,) = scratch(tmp_path)
        demo = mine / "files/notebooks/demos/01_deadlock.ipynb"
        demo.write_text("typed by somebody")
        with presented(course, tmp_path / "second", "1") as second:
            assert first.address != second.address
            assert len({domain_of(first), domain_of(second)}) == 2
        (again,) = scratch(tmp_path)
        assert again == mine
        assert demo.read_text() == "typed by somebody"
        assert first.get("status")

"""What is masked stays so under every name it has, and with both ways of keeping to a list of files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit.grading import isolation_status
from course_kit.grading.sandbox import file_view, namespaces
from course_kit.grading.sandbox.file_view import FileView
from course_kit.process.child import fork_child

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

PATHS = ("home/me/venv", "data/home/me/venv", "data/home/me/venv/lib64/..", "data/home/me/again", "short")


@pytest.fixture
def places() -> Iterator[Path]:
    """A virtual environment with a secret in it, in a home that a link leads to, and some links more."""
    with tempfile.TemporaryDirectory(dir="/var/tmp") as made:
        folder = Path(made).resolve()
        venv = folder / "data/home/me/venv"
        (venv / "lib/graders").mkdir(parents=True)
        (venv / "lib/graders/checks.py").write_text("SECRET")
        (venv / "lib/all.zip").write_text("SECRET")
        (venv / "lib/library.py").write_text("public")
        (venv / "lib64").symlink_to("lib")
        (folder / "home").symlink_to("data/home")
        (folder / "short").symlink_to("home/me/venv")
        (folder / "data/home/me/again").symlink_to(folder / "home/me/venv")
        (folder / "scratch").mkdir()
        yield folder


def view_of(folder: Path) -> FileView:
    shown = (str(folder / "home/me/venv"), str(folder / "short"), str(folder / "home/me/again/lib64"), "/usr", "/lib64")
    masked = (str(folder / "home/me/venv/lib/graders"), str(folder / "data/home/me/venv/lib/all.zip"))
    return FileView().with_more(shown, masked)


def found(folder: Path) -> dict[str, list[str]]:
    """What can be read: by each name of the environment those files of three that are not empty."""
    read: dict[str, list[str]] = {}
    for path in PATHS:
        for name in (
            "lib/library.py",
            "lib64/library.py",
            "lib/graders/checks.py",
            "lib64/graders/checks.py",
            "lib64/all.zip",
        ):
            with suppress(OSError):
                if (folder / path / name).read_text():
                    read.setdefault(path, []).append(name)
    return read


def inside(arrange: Callable[[], None], folder: Path, *, processes: bool) -> dict[str, list[str]]:
    """What a process finds that has arranged its files."""
    reader, writer = os.pipe()

    def look() -> None:
        arrange()
        os.write(writer, json.dumps(found(folder)).encode())

    def start() -> None:
        if processes:
            namespaces.enter_processes()
        os.waitpid(fork_child(look), 0)

    child = fork_child(start)
    os.close(writer)
    with os.fdopen(reader) as told:
        answer = told.read()
    os.waitpid(child, 0)
    assert answer, "the files could not be arranged"
    return dict(json.loads(answer))


def test_a_file_system_of_its_own_shows_nothing_masked_by_any_name(places: Path) -> None:
    if not isolation_status().files:
        assert isolation_status().reason
        return
    scratch = str(places / "scratch")
    read = inside(lambda: file_view.lay_out(view_of(places), scratch, 1), places, processes=True)
    assert read["home/me/venv"] == read["short"] == ["lib/library.py", "lib64/library.py"]
    assert {name for names in read.values() for name in names} == {"lib/library.py", "lib64/library.py"}


def test_landlock_shows_nothing_masked_by_any_name(places: Path) -> None:
    if not file_view.landlock_version():
        assert not isolation_status().landlock
        return
    read = inside(lambda: file_view.restrict(view_of(places), ()), places, processes=False)
    assert set(read) == set(PATHS)
    assert all(names == ["lib/library.py", "lib64/library.py"] for names in read.values())


_ASK = "from course_kit.grading.sandbox import file_view; print(*file_view.find_view().shown, sep='\\n')"


@pytest.mark.parametrize("variable", ["PYTHONPATH", "AMENT_PREFIX_PATH"])
def test_a_home_that_a_variable_names_is_not_shown_by_its_real_name(variable: str, places: Path) -> None:
    home = places / "home/me"
    for named in (home, places / "data/home/me", places / "data", places / "home"):
        set_up = {**os.environ, "HOME": str(home), variable: str(named)}
        done = subprocess.run(
            [sys.executable, "-c", _ASK], env=set_up, capture_output=True, text=True, cwd="/", check=True
        )
        shown = done.stdout.splitlines()
        assert "/usr" in shown
        assert [line for line in shown if (f"{places}/data/home/me/").startswith(f"{line}/")] == []

"""Hundreds of hostile inboxes, made up by seeds: nothing fails, nobody vanishes, nobody gets another's work."""

from __future__ import annotations

import os
import sys
import warnings
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from course_kit.classroom.intake import collecting
from course_kit.grading import GradingError
from course_kit.grading.diagnosis import catalogue
from course_kit.grading.model.exercise import load_exercise
from tests.classroom.hostile_inboxes import Inbox, Maker

if TYPE_CHECKING:
    from collections.abc import Iterator

SERVICE = load_exercise("temperature_service")
SEEDS = range(12)  # each gives ten inboxes
EACH = 10
PYTHONS_OWN = (sys.prefix, sys.base_prefix)  # an encoding of names is imported when it is first met

pytestmark = pytest.mark.attack("Damaged archives")


class Opened:
    """Which files and folders this process has opened; Python tells an audit hook, which stays for good."""

    def __init__(self) -> None:
        self._paths: list[str] | None = None
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple[Any, ...]) -> None:
        if self._paths is not None and event in ("open", "os.scandir") and isinstance(arguments[0], (str, os.PathLike)):
            self._paths.append(os.fspath(arguments[0]))

    @contextmanager
    def listening(self) -> Iterator[list[str]]:
        self._paths = []
        try:
            yield self._paths
        finally:
            self._paths = None


@pytest.fixture(scope="module")
def opened() -> Opened:
    return Opened()


def collect(inbox: Inbox, home: Path, opened: Opened) -> collecting.Intake:
    with opened.listening() as paths:
        found = collecting.collect(inbox.source, (SERVICE,), home / "workspace")
    assert any(path.startswith(str(inbox.source)) for path in paths)
    own_texts = SERVICE.folder.parent  # what else the course wants, to tell another exercise's program
    codes = Path(catalogue.__file__).with_name("diagnoses.toml")
    ours = (home / "workspace", home / ".workspace_is_unpacked", own_texts, codes, os.devnull)
    places = (inbox.source, *ours, *PYTHONS_OWN)
    for path in paths:
        assert any(belongs(os.path.realpath(path), str(place)) for place in places), f"{path} was opened"
    return found


def belongs(path: str, entry: str) -> bool:
    return path == entry or path.startswith(f"{entry}/")


def check(inbox: Inbox, found: collecting.Intake) -> None:
    assert found.layout == inbox.layout
    honest = {entry.student: entry.source for entry in found.entries if entry.student in inbox.honest}
    assert honest == inbox.honest, "somebody's work was lost, or taken for another's"
    owners: dict[str, str] = {}
    for entry in found.entries:
        unit = next(one for one in inbox.entries if belongs(entry.source, one))
        assert owners.setdefault(unit, entry.student) == entry.student
        assert entry.student.isprintable()
        assert entry.name.isprintable()
    accounted = [*(entry.source for entry in found.entries), *(path for path, _ in found.left)]
    for unit in inbox.entries:
        assert any(belongs(path, unit) for path in accounted), f"{unit!a} has vanished"
    for student, reason in (*found.dropped, *found.odd):
        assert student.replace("\n", "").isprintable()
        assert reason
    assert len({(entry.student, entry.exercise) for entry in found.entries}) == len(found.entries)


@pytest.mark.parametrize("seed", SEEDS)
def test_hostile_folders(tmp_path: Path, opened: Opened, seed: int) -> None:
    for number in range(EACH):
        home = tmp_path / str(number)
        inbox = Maker(seed * EACH + number, home).folder()
        check(inbox, collect(inbox, home, opened))


@pytest.mark.parametrize("seed", SEEDS)
def test_hostile_zips(tmp_path: Path, opened: Opened, seed: int) -> None:
    for number in range(EACH):
        home = tmp_path / str(number)
        home.mkdir()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Duplicate name")
            inbox = Maker(1000 + seed * EACH + number, home).archive(broken=False)
        check(inbox, collect(inbox, home, opened))
        assert {path.name for path in home.iterdir()} <= {"all.zip", "workspace", ".workspace_is_unpacked"}
        assert not any(path.is_symlink() for path in (home / "workspace").rglob("*"))


@pytest.mark.parametrize("seed", SEEDS)
def test_broken_zips(tmp_path: Path, opened: Opened, seed: int) -> None:
    """Of an archive that is damaged nobody can say what was in it, but whose it is stays true, and it ends in words."""
    for number in range(EACH):
        home = tmp_path / str(number)
        home.mkdir()
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Duplicate name")
            inbox = Maker(5000 + seed * EACH + number, home).archive(broken=True)
        try:
            found = collect(inbox, home, opened)
        except GradingError as problem:
            assert str(problem).startswith("all.zip")  # noqa: PT017 - it may also be readable
            continue
        for entry in found.entries:
            assert (found.root / entry.source).is_file()
            if entry.student in inbox.honest and entry.source in inbox.honest.values():
                assert entry.source == inbox.honest[entry.student]

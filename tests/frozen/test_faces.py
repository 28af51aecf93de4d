"""What the commands say with --help, and what a class run writes for the inbox of each system: as it was frozen."""

from __future__ import annotations

import re
import sys
import zipfile
import zlib
from concurrent.futures import Future
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import check
from course_kit.classroom import exports
from course_kit.classroom.intake import collecting
from course_kit.cli.main import build_parser
from course_kit.grading.model.report import CheckReport, Report
from course_kit.ros2cli import parser as ros2_parser
from tests.classroom import system_inboxes
from tests.classroom.stand_ins import SERVICE, StandInForGrading, run

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from course_kit.grading.engine import GradingRequest

STUDENTS, ACCIDENTS = 7, 20
ONE = "st001@uni.example"  # whose result for each platform is looked at


def verbs_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    found = [action.choices for action in parser._actions if hasattr(action, "_name_parser_map")]
    return dict(found[0] or {}) if found else {}


def described(parser: argparse.ArgumentParser) -> Iterator[str]:
    yield parser.format_help()
    for verb in verbs_of(parser).values():
        yield from described(verb)


def in_one_layout(text: str) -> str:
    """Pythons lay the same help out in several ways."""
    text = re.sub(r"\n {12,}(?=\S)", "  ", text)
    text = re.sub(r"(-\w) (\S+), (--[\w-]+) \2", r"\1, \3 \2", text)
    return re.sub(r"(?<=\S) {2,}", "  ", text).rstrip() + "\n"


def test_each_verb_describes_itself_as_before(frozen: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "1000")
    monkeypatch.setattr(sys, "argv", ["course-kit"])
    said = [*described(build_parser()), check._parser().format_help()]
    for command in ros2_parser.COMMANDS:
        said += list(described(verbs_of(ros2_parser.build_parser([command]))[command]))
    frozen("help.txt", "\n".join(map(in_one_layout, said)))


class Marking(StandInForGrading):
    """Gives each program some of three checks, by its text."""

    def submit(self, request: GradingRequest) -> Future[Report]:
        number = zlib.crc32(request.text.source.encode())
        checks = tuple(
            CheckReport(f"check_{place}", f"Check {place}", "passed" if right else "failed", 3.0, points=3.0 * right)
            for place, right in enumerate(number >> place & 1 for place in range(3))
        )
        done: Future[Report] = Future()
        points = sum(one.points for one in checks)
        made_for = (request.exercise.id, request.exercise.title, request.shown)
        done.set_result(Report(*made_for, "graded", points >= 6, points, request.exercise.points, 0.0, checks))
        return done


@pytest.mark.parametrize("system", system_inboxes.SYSTEMS)
def test_a_class_run_writes_for_each_system_what_it_did(
    system: str, frozen: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(system_inboxes, "PEOPLE", system_inboxes.PEOPLE[:STUDENTS])
    source, out = system_inboxes.Maker(system, tmp_path).source, tmp_path / "out"
    exports.write_all(run(source, out, Marking(), exercises=(SERVICE,), seed=7), out)
    written = {path.relative_to(out).as_posix(): path for path in sorted(out.rglob("*")) if path.is_file()}
    frozen(f"class_{system.replace(' ', '_')}.txt", "\n".join(map(shown, written, written.values())))


@pytest.mark.parametrize("system", system_inboxes.SYSTEMS)
def test_an_intake_tells_of_every_accident_what_it_told(
    system: str, frozen: Callable[..., None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(system_inboxes, "PEOPLE", system_inboxes.PEOPLE[:ACCIDENTS])
    source = system_inboxes.Maker(system, tmp_path).source
    found = collecting.collect_submissions(source, (SERVICE,), tmp_path / "handed_in")
    assert all((found.root / entry.source).is_file() for entry in found.entries)
    written = collecting.write_intake(found, tmp_path)
    frozen(f"intake_{system.replace(' ', '_')}.txt", written.read_text(encoding="utf-8-sig"))


def shown(name: str, path: Path) -> str:
    """Tables as they are, of archives the members; of what is there for each student one, of all else the name."""
    if path.suffix == ".zip":
        return "\n".join([f"== {name}", *zipfile.ZipFile(path).namelist(), ""])
    is_result = name.startswith("exports/") and f"/{ONE}" in name
    if path.suffix == ".csv" or (is_result and path.suffix != ".html"):
        return f"== {name}\n{path.read_text(encoding='utf-8-sig').rstrip()}\n"
    return f"== {name}"

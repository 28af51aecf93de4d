"""Sixty students in the layout of each system, with the accidents that happen: the table, file by file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.intake import collecting, table
from course_kit.text.sanitize import one_line

from .accidents import SERVICE
from .system_inboxes import CLASS_SIZE, SYSTEMS, Maker

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("system", SYSTEMS)
def test_every_student_and_every_file_is_in_the_table(tmp_path: Path, system: str) -> None:
    inbox = Maker(system, tmp_path).inbox
    found = collecting.collect_submissions(inbox.source, (SERVICE,), tmp_path / "handed_in")
    assert found.layout == inbox.layout
    rows = table.intake_rows(found)
    assert {row.student: (row.source, row.why) for row in rows if row.student} == inbox.chosen
    assert len(inbox.chosen) == CLASS_SIZE
    others = {row.source: row.why for row in rows if not row.student}
    tools = {path for path in others if others[path] in ("a folder of a tool", "a file of a tool")}
    assert {path: why for path, why in others.items() if path not in tools} == {
        path: why for path, why in inbox.left.items() if path not in tools
    }
    assert {row.student: row.worry for row in rows if row.worry} == inbox.worries
    assert {row.student for row in rows if row.late} == inbox.late
    assert (found.dropped, found.missing, found.odd) == ((), (), ())
    assert all((found.root / entry.source).is_file() for entry in found.entries)
    assert len({row.source for row in rows}) == len(rows), "every file once"
    assert all(row.source == one_line(row.source) for row in rows)

"""Our file for nbgrader beside the one that a real nbgrader writes of the same grades."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from tests.classroom.exports import rules
from tests.classroom.exports.books import SERVICE, bad, book, good

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.filterwarnings("ignore::sqlalchemy.exc.SAWarning")  # nbgrader's own way with its database
def test_nbgrader_itself_writes_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from nbgrader.api import Gradebook as RealGradebook  # so large that each worker would feel it
    from nbgrader.plugins.export import CsvExportPlugin

    # The version that it notes of its database costs a start of Alembic and plays no part here.
    monkeypatch.setattr("nbgrader.api.get_alembic_version", lambda: "head")
    with RealGradebook(f"sqlite:///{tmp_path / 'gradebook.db'}") as real:
        real.add_assignment(SERVICE.id)
        real.add_notebook("answer", SERVICE.id)
        for part in ("first", "second"):
            real.add_grade_cell(part, "answer", SERVICE.id, max_score=5, cell_type="code")
        for student, points in (("jane", 5.0), ("jörg", 0.0)):
            real.add_student(student)
            real.add_submission(SERVICE.id, student)
            for part in ("first", "second"):
                real.find_grade(part, "answer", SERVICE.id, student).auto_score = points
        real.add_student("li")
        real.db.commit()
        CsvExportPlugin(to=str(tmp_path / "real.csv")).export(real)
    gradebook = book(good("jane"), bad("jörg"), missing=(("li", SERVICE.id),))
    ours = dict(exports.export_files(gradebook))["exports/nbgrader.csv"]
    header, *rows = rules.rows_of((tmp_path / "real.csv").read_text(encoding="utf-8"))
    our_header, *our_rows = rules.rows_of(ours)
    assert our_header == header
    numbers = ("raw_score", "late_submission_penalty", "score", "max_score")

    def comparable(row: list[str]) -> list[str | float]:
        return [float(cell) if name in numbers else cell for name, cell in zip(header, row, strict=True)]

    assert [comparable(row) for row in our_rows] == sorted(comparable(row) for row in rows)

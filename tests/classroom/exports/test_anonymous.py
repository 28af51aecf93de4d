"""Reports without names: nothing in them tells whose they are."""

from __future__ import annotations

import random
import re
from typing import TYPE_CHECKING

from course_kit.classroom.exports import anonymous
from course_kit.classroom.records import RecordFolder
from course_kit.cli.main import main
from tests.classroom.exports import books, rules
from tests.classroom.exports.books import bad, book, good, unreadable

if TYPE_CHECKING:
    from pathlib import Path

    import pytest

    from course_kit.classroom.records import GradeRecord


def of_jane() -> GradeRecord:
    """Somebody whose name stands wherever it can stand."""
    jane = bad("jdoe42", name="Jane van Doe", source="Jane van Doe_4711_assignsubmission_file/jane.py", late=True)
    jane.report["checks"][0].update(
        got="node 'JANE_node', by jdoe42", message="Doe, line 3 of jane.py: 4711", hint="Jane?"
    )
    jane.report.update(stdout="hello from Jane", stderr="/home/jdoe42/x.py")
    jane.entry.platform.update(moodle_participant="4711")
    return jane


def test_no_name_number_file_or_output_of_anybody_is_left(tmp_path: Path) -> None:
    hidden = unreadable("li", name="Li Na")
    hidden.report["stderr"] = "Li Na.py is empty."
    anonymous.write_anonymous_pages(book(of_jane(), good("ole"), hidden), tmp_path / "out")
    files = {
        path.relative_to(tmp_path / "out").as_posix(): path.read_text() for path in (tmp_path / "out").rglob("*.*")
    }
    assert set(files) == {"grades.csv", *(f"student-{one}/temperature_service.html" for one in (1, 2, 3))}
    for name, text in files.items():
        shown = re.sub(r"<style>.*?</style>", "", text, flags=re.DOTALL)
        assert not re.search(r"jane\.|jdoe42|\bdoe\b|4711|hello from|li na|\bole\b", shown, re.IGNORECASE), name
    assert "Expected" in "".join(files.values()), "what failed is still told"


def test_the_scores_are_there_and_the_order_tells_nothing(tmp_path: Path) -> None:
    gradebook = books.large_book(12)
    orders = set()
    for seed in range(3):
        out = anonymous.write_anonymous_pages(gradebook, tmp_path / str(seed), random.Random(seed))  # noqa: S311 - an example
        header, *rows = rules.rows_of((out / "grades.csv").read_text(encoding="utf-8-sig"))
        assert header == ["student", "exercise", "score", "max", "status"]
        assert len(rows) == len(gradebook.records)
        assert sum(float(row[2]) for row in rows) == sum(one.score for one in gradebook.records)
        orders.add(tuple(row[2] for row in rows))
    assert len(orders) == 3


def test_the_command_reads_a_runs_folder_and_never_writes_over_anything(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for one in (of_jane(), good("ole")):
        RecordFolder(tmp_path / "results").keep(one)
    command = ["export", "anonymous", str(tmp_path / "results"), "--to", str(tmp_path / "out")]
    assert main(command) == 0
    assert len(list((tmp_path / "out").rglob("*.html"))) == 2
    assert main(command) == 2
    assert "already exists" in capsys.readouterr().err

"""Lateness, penalties, overrides and comments arrive in every export; the score that counts is the same in all."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.exports import page
from course_kit.classroom.rules.adjustments import Adjustment
from tests.classroom.exports.books import SERVICE, book, good, not_graded, unreadable

if TYPE_CHECKING:
    from course_kit.classroom.records import Gradebook, GradeRecord

ZONE = timezone(timedelta(hours=1))
DUE = datetime(2026, 11, 20, 23, 59, tzinfo=ZONE)
LATE = Adjustment(
    pass_mark=SERVICE.pass_mark,
    submitted=DUE + timedelta(days=1, hours=2),
    due=DUE,
    late=True,
    late_s=26 * 3600,
    penalty=2.0,
)
SET = replace(LATE, override=9.5, comment="Shown to me <on Monday>.")


def files(gradebook: Gradebook) -> dict[str, str]:
    return dict(exports.export_files(gradebook))


def adjusted(record: GradeRecord, adjustment: Adjustment) -> GradeRecord:
    return replace(record, adjustment=adjustment)


@pytest.mark.parametrize(("adjustment", "score"), [(LATE, 8.0), (SET, 9.5)])
def test_every_export_has_the_score_that_counts(adjustment: Adjustment, score: float) -> None:
    record = adjusted(good("jane", platform={"moodle_participant": "7", "canvas_user": "8"}), adjustment)
    written = files(book(record))
    shown_score = f"{score:g}"
    rows = {name: list(csv.reader(io.StringIO(text))) for name, text in written.items() if name.endswith(".csv")}
    assert rows["grades.csv"][1][2] == shown_score
    assert rows["exports/canvas.csv"][-1][-1] == shown_score
    assert rows["exports/moodle_temperature_service.csv"][1][3] == shown_score
    nbgrader = dict(zip(*rows["exports/nbgrader.csv"], strict=True))
    assert (nbgrader["raw_score"], nbgrader["late_submission_penalty"], nbgrader["score"]) == ("10", "2", shown_score)
    assert (nbgrader["duedate"], nbgrader["timestamp"]) == ("2026-11-20 22:59:00", "2026-11-22 00:59:00")
    results = {name: json.loads(text) for name, text in written.items() if name.endswith(".json")}
    assert results["exports/gradescope/jane/temperature_service/results.json"]["score"] == score
    assert f'data-value="{shown_score}"' in page.render_class(book(record))


def test_a_penalty_can_cost_the_pass_and_never_more_than_all_points() -> None:
    assert not adjusted(good("jane"), replace(LATE, penalty=4.0)).passed
    assert adjusted(good("jane"), replace(LATE, penalty=99.0)).score == 0.0


def test_a_score_that_the_instructor_sets_is_a_grade_where_the_grader_failed() -> None:
    failed, set_by_hand = not_graded("ann"), adjusted(not_graded("bob"), SET)
    gradebook = book(failed, set_by_hand, adjusted(unreadable("cem"), SET))
    assert [one.entry.student for one in gradebook.not_graded] == ["ann"]
    assert dict(gradebook.tally()) == {"error": 1, "passed": 2}

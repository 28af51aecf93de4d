"""What each platform's own reader asks for, written down as a reader; each says what it rests on."""

from __future__ import annotations

import csv
import io
import json
from typing import Any

import jsonschema

STUDENT_COLUMNS = 5

# Rests on the "Autograder Specifications" of Gradescope's documentation, section "Output format".
_VISIBILITY = {"enum": ["visible", "hidden", "after_due_date", "after_published"]}
_FORMAT = {"enum": ["text", "html", "simple_format", "md", "ansi"]}
GRADESCOPE = {
    "type": "object",
    "additionalProperties": False,
    "anyOf": [{"required": ["score"]}, {"required": ["tests"]}],
    "properties": {
        "score": {"type": "number"},
        "execution_time": {"type": "number", "minimum": 0},
        "output": {"type": "string"},
        "output_format": _FORMAT,
        "test_output_format": _FORMAT,
        "test_name_format": _FORMAT,
        "visibility": _VISIBILITY,
        "stdout_visibility": _VISIBILITY,
        "extra_data": {"type": "object"},
        "leaderboard": {"type": "array"},
        "tests": {
            "type": "array",
            "items": {
                "type": "object",
                "additionalProperties": False,
                "properties": {
                    "score": {"type": "number"},
                    "max_score": {"type": "number"},
                    "status": {"enum": ["passed", "failed"]},
                    "name": {"type": "string"},
                    "name_format": _FORMAT,
                    "number": {"type": "string"},
                    "output": {"type": "string"},
                    "output_format": _FORMAT,
                    "tags": {"type": "array", "items": {"type": "string"}},
                    "visibility": _VISIBILITY,
                    "extra_data": {"type": "object"},
                },
            },
        },
    },
}

# Rests on schemas/result-v1.schema.json of foundation50/classroom50; that no score exceeds its most is in its code.
_POINTS = {"type": "integer", "minimum": 0}
_SAID = {"type": "string", "minLength": 1}
_MOMENT = {"type": "string", "pattern": r"^\d{4}-\d{2}-\d{2}T([01]\d|2[0-3]):[0-5]\d:[0-5]\dZ$"}
CLASSROOM50: dict[str, Any] = {
    "type": "object",
    "additionalProperties": False,
    "properties": {
        "schema": {"const": "classroom50/result/v1"},
        "assignment_type": {"enum": ["individual", "group"]},
        "submission": {"type": "string", "pattern": "^submit/"},
        **dict.fromkeys(("classroom", "assignment", "owner", "commit", "release", "review"), _SAID),
        **dict.fromkeys(("datetime", "graded_at"), _MOMENT),
        **dict.fromkeys(("score", "max-score"), _POINTS),
        "tests": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["test-name", "passed", "score", "max-score"],
                "properties": {
                    "test-name": _SAID,
                    "passed": {"type": "boolean"},
                    "score": _POINTS,
                    "max-score": _POINTS,
                },
            },
        },
    },
}
CLASSROOM50["required"] = [name for name in CLASSROOM50["properties"] if name != "graded_at"]


def rows_of(text: str) -> list[list[str]]:
    return list(csv.reader(io.StringIO(text, newline=""), strict=True))


def canvas(text: str) -> tuple[dict[str, float], list[dict[str, str]]]:
    """Points possible by assignment, and the students' rows; rests on the source of Canvas's gradebook importer."""
    header, *rows = rows_of(text)
    assert len(header) > 3
    assert "Student" in header[0]
    assert "ID" in header[1]
    assert header[2:STUDENT_COLUMNS] == ["SIS User ID", "SIS Login ID", "Section"]
    points: dict[str, float] = {}
    students = []
    for row in rows:
        assert len(row) == len(header)
        if "Points Possible" in row[0]:
            assert not points
            points = {name: float(value) for name, value in zip(header, row, strict=True) if value and value != row[0]}
            continue
        assert row[1] == "" or row[1].isdigit()
        assert any(row[:4])
        assert all(grade == "" or float(grade) >= 0 for grade in row[STUDENT_COLUMNS:])
        students.append(dict(zip(header, row, strict=True)))
    return points, students


def moodle(text: str) -> dict[int, dict[str, str]]:
    """Rows by participant; rests on the source of Moodle's offline grading (mod/assign/feedback/offline)."""
    header, *rows = rows_of(text)
    assert {"Identifier", "Grade", "Last modified (grade)"} <= set(header)
    found = {}
    for row in rows:
        assert len(row) == len(header)
        named = dict(zip(header, row, strict=True))
        assert named["Identifier"].startswith("Participant ")
        if named["Grade"]:
            assert 0 <= float(named["Grade"]) <= float(named["Maximum Grade"])
        found[int(named["Identifier"][len("Participant ") :])] = named
    return found


def gradescope(text: str) -> dict[str, Any]:
    result: dict[str, Any] = json.loads(text)
    jsonschema.validate(result, GRADESCOPE)
    return result


def classroom50(text: str) -> dict[str, Any]:
    result: dict[str, Any] = json.loads(text)
    jsonschema.validate(result, CLASSROOM50)
    assert all(one["score"] <= one["max-score"] for one in (result, *result["tests"]))
    assert result["score"] == sum(test["score"] for test in result["tests"])
    assert result["max-score"] == sum(test["max-score"] for test in result["tests"])
    return result

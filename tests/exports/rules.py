"""What each platform's own reader asks for, written down as a reader; each says what it rests on."""

from __future__ import annotations

import base64
import csv
import io
import json
from typing import Any
from xml.etree import ElementTree as ET

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

# Rests on the source of GitHub's actions autograding-grading-reporter (which fields it reads) and
# autograding-command-grader (which it writes).
GITHUB = {
    "type": "object",
    "required": ["version", "status", "max_score", "tests"],
    "additionalProperties": False,
    "properties": {
        "version": {"const": 1},
        "status": {"enum": ["pass", "fail", "error"]},
        "max_score": {"type": "number"},
        "tests": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["name", "status", "score", "message"],
                "properties": {
                    "name": {"type": "string"},
                    "status": {"enum": ["pass", "fail", "error"]},
                    "score": {"type": "number"},
                    "message": {"type": ["string", "null"]},
                },
            },
        },
    },
}

# Rests on the schema junit-10.xsd of Jenkins's xUnit plugin: an element's attributes (those with ! are a must) and
# children; and on Ant's schema for the order properties, then test cases, and one outcome for each test case.
_OUTCOME = ({"type", "message"}, set())
JUNIT: dict[str, tuple[set[str], set[str]]] = {
    "testsuites": ({"name", "time", "tests", "failures", "errors"}, {"testsuite"}),
    "testsuite": (
        {"name!", "tests!", "failures!", "errors!", "group", "time", "skipped", "timestamp", "hostname", "id"}
        | {"package", "file", "log", "url"},
        {"testsuite", "properties", "testcase", "system-out", "system-err"},
    ),
    "properties": (set(), {"property"}),
    "property": ({"name!", "value!"}, set()),
    "testcase": ({"name!", "time", "classname", "group"}, {"skipped", "error", "failure", "system-out", "system-err"}),
    "failure": _OUTCOME,
    "error": _OUTCOME,
    "skipped": _OUTCOME,
}


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


def github(line: str) -> tuple[dict[str, Any], float]:
    """The result and the points that the reporter would announce."""
    name, _, encoded = line.strip().partition("=")
    assert name == "result"
    result: dict[str, Any] = json.loads(base64.b64decode(encoded, validate=True))
    jsonschema.validate(result, GITHUB)
    return result, sum(test["score"] for test in result["tests"])


def junit(text: str) -> ET.Element:
    root = ET.fromstring(text)  # noqa: S314 - our own
    assert root.tag == "testsuites"
    _follow(root)
    for suite in root:
        tags = [child.tag for child in suite]
        assert tags == ["properties", *["testcase"] * (len(tags) - 1)]
        cases = suite.findall("testcase")
        assert all(len(case) <= 1 for case in cases)
        assert int(suite.attrib["tests"]) == len(cases)
        for attribute, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
            assert int(suite.attrib[attribute]) == sum(case.find(tag) is not None for case in cases)
    for attribute in ("tests", "failures", "errors"):
        assert int(root.attrib[attribute]) == sum(int(suite.attrib[attribute]) for suite in root)
    return root


def _follow(element: ET.Element) -> None:
    attributes, children = JUNIT[element.tag]
    assert {name[:-1] for name in attributes if name.endswith("!")} <= set(element.attrib)
    assert set(element.attrib) <= {name.rstrip("!") for name in attributes}
    for child in element:
        assert child.tag in children
        _follow(child)

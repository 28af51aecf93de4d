"""Results as platforms' autograders leave them behind: Gradescope's `results.json`, Classroom 50's `result.json`.

Classroom 50 follows schemas/result-v1.schema.json of foundation50/classroom50: whole numbers only, so that points are
scaled; who and what was graded comes from the environment of its runner, which checks and stamps it again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.classroom.exports.texts import describe_problem, explain_check, json_text, result_headline
from course_kit.classroom.records import safe_name
from course_kit.grading.errors import GradingError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from datetime import datetime

    from course_kit.classroom.records import Gradebook, GradeRecord

GRADESCOPE = "exports/gradescope/{}/{}/results.json"
SCHEMA = "classroom50/result/v1"
SCALE = 10  # for each point: checks are worth multiples of half a point
_NEEDED = ("CLASSROOM", "ASSIGNMENT", "SUBMISSION_TAG", "COMMIT_URL", "RELEASE_URL")


def export_results(book: Gradebook) -> Iterator[tuple[str, str]]:
    """For Gradescope: a file for each grade, but none where the grader itself failed."""
    for record in book.graded_records():
        path = GRADESCOPE.format(safe_name(record.entry.student), record.entry.exercise)
        yield path, json_text(gradescope_result(record)) + "\n"


def gradescope_result(record: GradeRecord) -> dict[str, Any]:
    """The result as Gradescope's specification has it."""
    output = "\n\n".join(filter(None, (result_headline(record), *record.remarks, describe_problem(record))))
    whose = {"student": record.entry.student} if record.entry.student else {}  # its own autograder need not know
    return {
        "score": record.score,
        "execution_time": record.report["duration_s"],
        "output": output,
        "output_format": "text",
        "test_output_format": "text",
        "test_name_format": "text",
        "visibility": "visible",
        "stdout_visibility": "hidden",
        "extra_data": {"exercise": record.entry.exercise, **whose, "seed": record.seed},
        "tests": [_gradescope_test(number, check) for number, check in enumerate(record.report["checks"], start=1)],
    }


def _gradescope_test(number: int, check: dict[str, Any]) -> dict[str, Any]:
    return {
        "name": check["title"],
        "number": str(number),
        "score": check["points"],
        "max_score": check["max_points"],
        "status": "passed" if check["status"] == "passed" else "failed",
        "output": explain_check(check),
        "tags": [check["id"], *([check["diagnosis"]] if check["diagnosis"] else [])],
        "visibility": "visible",
    }


def require_runner(variables: Mapping[str, str]) -> None:
    """See that this runs in Classroom 50."""
    if missing := [name for name in _NEEDED if not variables.get(name)]:
        raise GradingError(
            f"Classroom 50's runner sets {', '.join(_NEEDED)}; here {', '.join(missing)} "
            f"{'is' if len(missing) == 1 else 'are'} missing. Run this in its workflow, or use --format json."
        )


def classroom50_result(record: GradeRecord, variables: Mapping[str, str], now: datetime) -> dict[str, Any]:
    """The result as the schema has it."""
    require_runner(variables)
    tests = [_classroom50_test(check) for check in record.report["checks"]] or [_could_not_be_read(record)]
    moment = f"{now:%Y-%m-%dT%H:%M:%SZ}"
    return {
        "schema": SCHEMA,
        "classroom": variables["CLASSROOM"],
        "assignment": variables["ASSIGNMENT"],
        "assignment_type": variables.get("ASSIGNMENT_TYPE") or "individual",
        "owner": variables.get("OWNER") or variables.get("USERNAME") or variables.get("GITHUB_ACTOR") or "unknown",
        "submission": variables["SUBMISSION_TAG"],
        "commit": variables["COMMIT_URL"],
        "release": variables["RELEASE_URL"],
        "review": variables.get("REVIEW_URL") or variables["COMMIT_URL"],
        "datetime": moment,  # the runner puts the commit's in its place
        "graded_at": moment,
        "score": sum(test["score"] for test in tests),
        "max-score": sum(test["max-score"] for test in tests),
        "tests": tests,
    }


def _classroom50_test(check: dict[str, Any]) -> dict[str, Any]:
    """One check; schema and collector keep further fields as they are."""
    most = round(SCALE * check["max_points"])
    return {
        "test-name": check["title"],
        "passed": check["status"] == "passed",
        "score": min(most, round(SCALE * check["points"])),
        "max-score": most,
        "output": explain_check(check),
    }


def _could_not_be_read(record: GradeRecord) -> dict[str, Any]:
    return {
        "test-name": "The submission can be graded",
        "passed": False,
        "score": 0,
        "max-score": round(SCALE * record.max_score),
        "output": f"{result_headline(record)} {describe_problem(record)}",
    }

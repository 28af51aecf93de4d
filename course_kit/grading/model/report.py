"""The report of one grading, as data and as JSON."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.ros.graph import Overview  # noqa: TC001 - msgspec looks it up
from course_kit.ros.sequence import Arrow  # noqa: TC001 - as above
from course_kit.text.console import in_points
from course_kit.text.sanitize import make_encodable

if TYPE_CHECKING:
    from course_kit.grading.model.catalogue import Diagnosis
    from course_kit.grading.model.plain_data import Record

FORMAT_VERSION = 1
_DIGITS = 6
# What the JSON has of each check, in this order.
FIELDS = ("id", "title", "status", "points", "max_points", "sent", "expected", "got", "diagnosis", "message", "hint")


@dataclass(frozen=True)
class CheckResult:
    """How a check went: `status` is passed, failed, skipped or error; `steps` what crossed the wire if it failed."""

    id: str
    title: str
    status: str
    max_points: float
    sent: str = ""
    expected: str = ""
    got: str = ""
    diagnosis: str | None = None
    message: str = ""
    steps: tuple[Arrow, ...] = ()
    proves: tuple[str, ...] = ()
    graph: Overview | None = None  # who talked to whom, of a submission of several programs


@dataclass(frozen=True)
class CheckReport(CheckResult):
    """How one check went, for the learner: a `CheckResult` whose message also tells why, and what it is worth."""

    points: float = 0.0  # what it has earned
    hint: str | None = None  # the first hint, None without any
    told: str = ""  # what happened, without the reason and the link that `message` adds
    more_hints: tuple[str, ...] = ()  # what may follow on `hint`, the next one first
    known: Diagnosis | None = None  # the entry of `diagnosis` in the catalogue, as the exercise words it


@dataclass(frozen=True)
class Report:
    """The outcome of one grading; there is one whatever happens."""

    exercise: str  # the exercise's id
    title: str  # the exercise's title
    submission: str  # the submission's path or name
    status: str  # graded, unreadable, crashed (it ended before it could be asked) or error (not the learner's fault)
    passed: bool = False  # whether the score reaches the pass mark
    score: float = 0.0  # the points of all passed checks
    max_score: float = 0.0  # full marks
    duration_s: float = 0.0  # from the call to the verdict
    checks: tuple[CheckReport, ...] = ()  # each check, in the order they were run
    stdout: str = ""  # first and last 4 kB of what the submission printed
    stderr: str = ""  # the same of its errors; ROS 2 logs go there
    problem: str = ""  # why there is no grade, when the status is unreadable or error
    isolation: str = ""  # what kept the submission apart from the machine, in one line
    part: str = ""  # the part that was graded alone, whose points are its full marks; empty for all
    practice: bool = False  # whether it has no points: a drill is solved, or not yet
    seed: int = 0  # what its checks drew from

    @property
    def verdict(self) -> str:
        """What was reached, in words: `8 of 10 points, passed`; of a drill `solved`."""
        if self.practice:
            return "solved" if self.passed else "not solved yet"
        return f"{self.score:g} of {in_points(self.max_score)}, {self.passed_in_words}"

    @property
    def passed_in_words(self) -> str:
        """Whether it is enough, in words; of a part alone, which one it is."""
        return f"{self.part} alone" if self.part else "passed" if self.passed else "not passed yet"

    @property
    def run(self) -> list[CheckReport]:
        """The checks that were run: those that failed come first."""
        found = (check for check in self.checks if check.status != "skipped")
        return sorted(found, key=lambda check: check.status == "passed")

    @property
    def not_run(self) -> dict[str, list[CheckReport]]:
        """The other checks, by why they were not run."""
        found: dict[str, list[CheckReport]] = {}
        for check in self.checks:
            if check.status == "skipped":
                found.setdefault(check.message.rstrip("."), []).append(check)
        return found

    def to_mapping(self) -> Record:
        """The report as JSON has it: exactly these names."""
        return {
            "format_version": FORMAT_VERSION,
            **_rounded(self, "exercise", "submission", "status", "score", "max_score", "passed"),
            "duration_s": round(self.duration_s, 3),
            "checks": [_rounded(check, *FIELDS) for check in self.checks],
            "stdout": self.stdout,
            "stderr": self.stderr or self.problem,
        }

    def to_json(self) -> str:
        """One JSON document, without a trailing line end."""
        return make_encodable(json.dumps(self.to_mapping(), indent=2, ensure_ascii=False, allow_nan=False))


def _rounded(whole: Report | CheckReport, *names: str) -> Record:
    values = {name: getattr(whole, name) for name in names}
    return {name: round(value, _DIGITS) if isinstance(value, float) else value for name, value in values.items()}


def exit_code(report: Report) -> int:
    """0 for a pass, 1 for a grade below the pass mark, 2 when it could not be graded."""
    if report.status in ("unreadable", "error"):
        return 2
    return 0 if report.passed else 1

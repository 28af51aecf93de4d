"""How `course-kit dev check` shows what it does and what it has found."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, TextIO

from course_kit.authoring import rules
from course_kit.grading import exercise_folders
from course_kit.grading.diagnosis import catalogue
from course_kit.text.console import in_points, wrapped

if TYPE_CHECKING:
    from collections.abc import Callable

    from course_kit.authoring.check import ProofOutcome, Run
    from course_kit.authoring.corpus import Corpus, ProofSubmission
    from course_kit.grading import Report

FORMAT_VERSION = 1
_WIDTH = 100
_EACH = 25  # gradings from one line of progress to the next, where lines cannot be written over
_COLUMNS = {
    "starter": "starter",
    "solution": "solution",
    "variants": "variant",
    "broken": "broken",
    "slips": "slip",
}


def progress(stream: TextIO) -> Callable[[int, int, ProofSubmission, Report], None]:
    """Something to call after each grading; keeps one line up to date on a terminal, else writes some.

    A verdict that differs from an earlier one of the same submission is told at once: the end may be an hour away.
    """
    terminal = stream.isatty()
    before: dict[ProofSubmission, Report] = {}

    def show(done: int, total: int, submission: ProofSubmission, report: Report) -> None:
        what = f"{submission.exercise} {submission.kind} {submission.name}: {in_points(report.score)}"
        line = f"[{done:>{len(str(total))}}/{total}] {what}, {report.duration_s:.1f} s"
        earlier = before.setdefault(submission, report)
        if rules.verdict(report) != rules.verdict(earlier):
            name = f"{submission.exercise} {submission.kind} {submission.name}"
            stream.write(f"{name}: {rules.outcome(report)}. Earlier: {rules.outcome(earlier)}.\n")
        if terminal:
            stream.write(f"\r\x1b[K{line[:_WIDTH]}" + ("\r\x1b[K" if done == total else ""))
            stream.flush()
        elif done % _EACH == 0 or done == total:
            stream.write(f"{line}\n")
            stream.flush()

    return show


def as_text(found: ProofOutcome) -> str:
    """The table, what does not hold, and a summary."""
    names = [*_COLUMNS, "checks", "sentences", *(["stable"] if len(found.runs) > 1 else [])]
    width = max(len(one.task.id) for one in found.sets)
    lines = ["  ".join([f"{'exercise':<{width}}", *(f"{_heading(name):<10}" for name in names)]).rstrip()]
    for one in found.sets:
        cells = [_cell(found, one, name) for name in names]
        lines.append("  ".join([f"{one.task.id:<{width}}", *(f"{cell:<10}" for cell in cells)]).rstrip())
    if not all(exercise_folders.is_added(one.task.folder) for one in found.sets):
        lines += ["", _codes(found)]
    if found.faults:
        lines += ["", "What does not hold:"]
    for fault in found.faults:
        lines += wrapped(f"✗ {fault}", following="    ", width=_WIDTH)
    return "\n".join([*lines, "", _summary(found)])


def as_json(found: ProofOutcome) -> str:
    """The same as data."""
    return json.dumps(
        {
            "format_version": FORMAT_VERSION,
            "proven": not found.faults,
            "repeats": len(found.runs),
            "busy_processors": found.busy,
            "duration_s": round(found.duration_s, 1),
            "faults": [
                {"exercise": fault.exercise, "rule": fault.rule, "submission": fault.submission, "text": fault.text}
                for fault in found.faults
            ],
            "runs": [_run(run) for run in found.runs],
        },
        indent=2,
        ensure_ascii=False,
    )


def _run(run: Run) -> dict[str, object]:
    return {
        "seed": run.seed,
        "submissions": [
            {
                "exercise": submission.exercise,
                "kind": submission.kind,
                "name": submission.name,
                "status": report.status,
                "score": report.score,
                "duration_s": round(report.duration_s, 2),
                "checks": {check.id: [check.status, check.diagnosis] for check in report.checks},
            }
            for submission, report in run.reports.items()
        ],
    }


def _heading(name: str) -> str:
    return "same again" if name == "stable" else name


def _cell(found: ProofOutcome, one: Corpus, name: str) -> str:
    wrong = [fault for fault in found.faults if (fault.exercise, fault.rule) == (one.task.id, name)]
    if name == "stable":
        count = len(found.runs)
    elif name == "checks":
        count = len({check.id for each in one.of("solution") for check in found.runs[0].reports[each].checks})
    elif name == "sentences":
        count = len(one.task.sentences)
    else:
        count = len(one.of(_COLUMNS[name]))
    if not wrong:
        return f"✓ {count}" if count else "-"
    submissions = {fault.submission for fault in wrong}
    return f"✗ {len(submissions)} of {count}" if all(submissions) and count else "✗"


def _codes(found: ProofOutcome) -> str:
    named = {one.name for each in found.sets for one in each.submissions} & set(catalogue.catalogue())
    text = "diagnoses have a submission named after them that gets exactly that code"
    if found.partial:
        return f"{len(named)} {text} (of {len(catalogue.catalogue())}, all exercises together)"
    mark = "✗" if len(named) < len(catalogue.catalogue()) else "✓"
    return f"{mark} {len(named)} of {len(catalogue.catalogue())} {text}"


def _summary(found: ProofOutcome) -> str:
    count = sum(len(run.reports) for run in found.runs)
    first = found.runs[0]
    times, seeds = "once", f"seed {first.seed}"
    if len(found.runs) > 1:
        times, seeds = f"{len(found.runs)} times", f"seeds from {first.seed}"
    load = f", {found.busy} processors kept busy" if found.busy else ""
    proven = f"NOT PROVEN: {len(found.faults)} faults." if found.faults else "PROVEN."
    how = f"{len(first.reports)} submissions graded {times}, {count} gradings in {found.duration_s:.0f} s"
    return f"{proven} {how} ({seeds}{load})."

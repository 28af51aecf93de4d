"""Hand-made faults and odd right programs of the exercises with a node."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from course_kit.authoring import rules
from course_kit.authoring.corpus import ProofSubmission
from course_kit.authoring.gradings import Gradings
from course_kit.grading.model.exercise import load_exercise

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from course_kit.grading import Report

ROOT = Path(__file__).resolve().parents[2]
EXERCISES = tuple(sorted(path.stem for path in (Path(__file__).parent / "faults").glob("*.toml")))


@dataclass(frozen=True)
class Verdicts:
    """A program of a table and how it was graded, once for each seed."""

    program: ProofSubmission  # of the kind "fault" or "right"
    reports: dict[int, Report]  # by seed

    def unseen(self) -> Iterator[str]:
        """Of a fault what is wrong with its verdicts: full marks, or no points lost for the sentence that it breaks."""
        for seed, report in self.reports.items():
            if report.score >= report.max_score:
                yield f"seed {seed}: full marks"
            elif not _costs(self.program, seed, report):
                breaks = ", ".join(self.program.breaks)
                yield f"seed {seed}: nothing lost for '{breaks}': {rules.describe_report(report)}"

    def unjust(self) -> Iterator[str]:
        """Of a right program each verdict below full marks."""
        for seed, report in self.reports.items():
            if report.score < report.max_score:
                yield f"seed {seed}: {rules.describe_report(report)}"

    def complaints(self) -> list[str]:
        return list(self.unseen() if self.program.kind == "fault" else self.unjust())


def _costs(program: ProofSubmission, seed: int, report: Report) -> bool:
    checks = rules.checks_of(load_exercise(program.exercise), seed)
    proving = {one.id for one in checks if set(program.breaks) & set(one.proves)}
    return any(one.points < one.max_points for one in report.checks if one.id in proving)


def programs(exercise_id: str, kind: str) -> list[ProofSubmission]:
    """The faults ("fault") or the right programs ("right") of one exercise."""
    table, right = (Path(__file__).parent / part for part in (f"faults/{exercise_id}.toml", f"right/{exercise_id}"))
    told = msgspec.toml.decode(table.read_text(encoding="utf-8"))
    found = [
        ProofSubmission(
            exercise_id,
            kind,
            name,
            right / f"{entry['base']}.py"
            if "base" in entry
            else ROOT / "solutions" / exercise_id / f"{exercise_id}.py",
            changes=tuple((one["old"], one["new"]) for one in entry["changes"]),
            says=entry["says"],
            breaks=tuple([entry["breaks"]] if isinstance(entry.get("breaks"), str) else entry.get("breaks", ())),
            told_in=table,
        )
        for name, entry in told.get({"fault": "faults", "right": "right"}[kind], {}).items()
    ]
    if kind == "right":
        found += [ProofSubmission(exercise_id, kind, path.stem, path) for path in sorted(right.glob("*.py"))]
    return found


def grade_all(chosen: Sequence[ProofSubmission], seeds: Sequence[int]) -> list[Verdicts]:
    """Grade each program once for each seed, as a class is graded."""
    with Gradings([load_exercise(name) for name in {one.exercise for one in chosen}]) as pool:
        wanted = ((one, seed) for one in chosen for seed in seeds)
        reports = dict(pool.grade_all(((one, seed), pool.request_for(one, seed)) for one, seed in wanted))
    return [Verdicts(one, {seed: reports[one, seed] for seed in seeds}) for one in chosen]

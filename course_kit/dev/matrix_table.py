"""The table of `matrix`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.dev.steps import StepResult


def as_markdown(results: Mapping[str, Sequence[StepResult]], notes: Sequence[str]) -> str:
    """A row for each combination, a column for each step that any of them has gone through, and the notes.

    Args:
        results: by what the combination is called, such as "Python 3.10.13".
        notes: sentences about what was left out.
    """
    steps = list(dict.fromkeys(result.step for ran in results.values() for result in ran))
    rows = [["Python", *steps], ["---"] * (1 + len(steps))]
    for name, ran in results.items():
        cells = {result.step: _cell(result) for result in ran}
        rows.append([name.removeprefix("Python "), *(cells.get(step, "not run") for step in steps)])
    lines = ["# The course on the Pythons of this machine", ""]
    lines += [f"| {' | '.join(row)} |" for row in rows] if results else ["Nothing was run."]
    lines += ["", *notes] if notes else []
    return "\n".join(lines) + "\n"


def _cell(result: StepResult) -> str:
    return f"{'FAILED: ' + result.problem if result.failed else 'passed'}, {result.seconds:.0f} s"

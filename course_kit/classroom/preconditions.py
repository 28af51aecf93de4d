"""What a run over a class needs before it begins: something to grade, and a folder of its own for the results."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from course_kit.classroom.intake.collecting import Intake
    from course_kit.grading.exercise import Exercise

WORKSPACE = "handed_in"  # where an archive is unpacked, in the output folder
_NAMED = 3  # things that are there where there is no submission


def require_submissions(found: Intake, sources: Sequence[Path], exercises: Sequence[Exercise]) -> None:
    """See that there is anything to grade."""
    if found.entries:
        return
    seen = [*found.dropped, *found.left][:_NAMED]
    wanted = ", ".join(exercise.id for exercise in exercises)
    raise GradingError(
        f"{', '.join(map(str, sources))} holds no submission for {wanted}, read with the layout "
        f"'{found.layout}'. It holds: "
        f"{'; '.join(f'{one_line(what)} ({one_line(why)})' for what, why in seen) or 'nothing'}. "
        "Name the right exercise with --exercise, or the layout with --layout."
    )


def require_folders_apart(sources: Sequence[Path], out: Path) -> None:
    """See that results are not taken for submissions, and that nothing handed in is written over."""
    for given in sources:
        try:
            source, results = given.resolve(), out.resolve()
        except (OSError, RuntimeError):  # a loop of links, which is said when one of them is opened
            continue
        if source == results or source in results.parents:
            raise GradingError(
                f"The results would lie among the submissions in {given}. Name another folder with --out."
            )
        if results in source.parents and (given.is_dir() or results / WORKSPACE in source.parents):
            raise GradingError(f"{given} lies in {out}, the folder for the results. Name another folder with --out.")

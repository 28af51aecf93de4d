"""Which notebooks can be presented, and which of them a name means."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.grading.errors import GradingError
from course_kit.interfaces.hints import nearest_name

if TYPE_CHECKING:
    from pathlib import Path

LESSONS = "notebooks"
DEMOS = f"{LESSONS}/demos"


class PresentationError(GradingError):
    """It cannot be presented; the text is for the speaker."""


def list_demos(root: Path) -> list[Path]:
    """The demos in their order."""
    found = sorted(path for path in (root / DEMOS).glob("*.ipynb") if path.is_file())
    if not found:
        raise PresentationError(
            f"There are no demos in {root / DEMOS}. Fetch the course again, or restore that folder."
        )
    return found


def find_notebook(root: Path, name: str) -> Path:
    """The demo or lesson that a speaker names; the first demo for an empty name."""
    demos = list_demos(root)
    if not name:
        return demos[0]
    everything = [*demos, *sorted((root / LESSONS).glob("*.ipynb"))]
    wanted = name.replace("\\", "/").rstrip("/").rpartition("/")[2].removesuffix(".ipynb").lower().replace("-", "_")
    wanted = wanted.zfill(2) if wanted.isdecimal() else wanted
    begun = [path for path in demos if wanted and _names(path)[1].startswith(wanted)]
    for group in ([path for path in everything if wanted in _names(path)], begun):
        if len(group) == 1 or (group and wanted.isdecimal()):  # lessons have numbers, too: demos come first
            return group[0]
    several = [path for path in everything if wanted and wanted in path.stem]
    if len(several) == 1:
        return several[0]
    if several:
        raise PresentationError(f"'{name}' fits {_join_names(several)}. Type one of them.")
    by_name = {title: path.stem for path in everything for title in _names(path)[:2]}
    near = nearest_name(wanted, by_name)
    hint = f" Did you mean {by_name[near]}?" if near else ""
    raise PresentationError(f"There is no demo called '{name}'.{hint} The demos: {_join_names(demos)}.")


def _names(path: Path) -> tuple[str, ...]:
    """What a notebook may be called: 01_deadlock, deadlock, 01."""
    number, _, title = path.stem.partition("_")
    return path.stem, title, number


def _join_names(paths: list[Path]) -> str:
    return ", ".join(path.stem for path in paths)

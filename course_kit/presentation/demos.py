"""Which notebooks can be presented, and which of them a name means."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.interfaces.hints import nearest

if TYPE_CHECKING:
    from pathlib import Path

LESSONS = "notebooks"
DEMOS = f"{LESSONS}/demos"


class PresentationError(RuntimeError):
    """It cannot be presented; the text is for the speaker."""


def demos(root: Path) -> list[Path]:
    """The demos in their order."""
    found = sorted(path for path in (root / DEMOS).glob("*.ipynb") if path.is_file())
    if not found:
        raise PresentationError(
            f"There are no demos in {root / DEMOS}. Fetch the course again, or restore that folder."
        )
    return found


def find(root: Path, name: str) -> Path:
    """The demo or lesson that a speaker names; the first demo for an empty name."""
    shown = demos(root)
    if not name:
        return shown[0]
    everything = [*shown, *sorted((root / LESSONS).glob("*.ipynb"))]
    wanted = name.replace("\\", "/").rstrip("/").rpartition("/")[2].removesuffix(".ipynb").lower().replace("-", "_")
    wanted = wanted.zfill(2) if wanted.isdecimal() else wanted
    for group in ([one for one in everything if wanted in _names(one)], [one for one in shown if _begins(one, wanted)]):
        if len(group) == 1 or (group and wanted.isdecimal()):  # lessons have numbers, too: demos come first
            return group[0]
    several = [one for one in everything if wanted and wanted in one.stem]
    if len(several) == 1:
        return several[0]
    if several:
        raise PresentationError(f"'{name}' fits {_listed(several)}. Type one of them.")
    raise PresentationError(
        f"There is no demo called '{name}'.{_meant(wanted, everything)} The demos: {_listed(shown)}."
    )


def _names(path: Path) -> tuple[str, ...]:
    """What a notebook may be called: 01_deadlock, deadlock, 01."""
    number, _, title = path.stem.partition("_")
    return path.stem, title, number


def _begins(path: Path, wanted: str) -> bool:
    return bool(wanted) and _names(path)[1].startswith(wanted)


def _meant(wanted: str, everything: list[Path]) -> str:
    """The nearest name, as a question."""
    by_name = {name: path.stem for path in everything for name in _names(path)[:2]}
    near = nearest(wanted, by_name)
    return f" Did you mean {by_name[near]}?" if near else ""


def _listed(paths: list[Path]) -> str:
    return ", ".join(path.stem for path in paths)

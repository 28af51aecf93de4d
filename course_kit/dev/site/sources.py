"""What the site is made of: pages of its own, the Markdown of the course, and its notebooks with their stored outputs.

They are put into one folder, as they lie in the course's, so that the links between them hold. README is the front
page.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit.dev import notebooks
from course_kit.grading import exercise
from course_kit.integrations import export

if TYPE_CHECKING:
    from collections.abc import Iterable

_PAGES = Path(__file__).parent / "pages"
_FRONT_END = "end_of_index.md"
_MARKDOWN = (
    "CHANGELOG.md",
    "CODE_OF_CONDUCT.md",
    "CONTRIBUTING.md",
    "SECURITY.md",
    "course_kit/authoring/AUTHORING.md",
    "course_kit/classroom/PRIVACY.md",
    "course_kit/grading/LIMITS.md",
    "course_kit/launch/OWN_PACKAGE.md",
)
_FOLDERS = ("course_kit/guides", "notebooks/pictures")
_LEXER = "lesson"  # see `lexer`
_ANCHOR = re.compile(r"(\.ipynb#)([^)\s]+)")
_END_OF_FOLDED = re.compile(r"[ \t]*\n*</details>")


def gather(root: Path, folder: Path) -> None:
    """Put together what Sphinx reads.

    Args:
        root: the course's folder.
        folder: an empty one.

    Raises:
        OSError: a file cannot be read or written.
        GradingError: an exercise.toml has a mistake.
    """
    own = folder / "exercises"
    for name in _FOLDERS:
        shutil.copytree(root / name, folder / name)
    for name in _MARKDOWN:
        _write(folder / name, _read(root / name))
    _write(folder / "index.md", _read(root / "README.md") + _read(_PAGES / _FRONT_END))
    lists = {"exercises": _in_order(root / own.name), "drills": _in_order(root / own.name / "drills")}
    for page in sorted(_PAGES.rglob("*.md")):
        if page.name != _FRONT_END:
            _write(folder / page.relative_to(_PAGES), _filled_in(_read(page), root, lists))
    for path in [*notebooks.with_outputs(root, drills=False), *(path for found in lists.values() for path in found)]:
        _write(folder / path.relative_to(root), nbformat.writes(for_reading(nbformat.read(path, as_version=4))))


def _in_order(folder: Path) -> list[Path]:
    """The notebooks of the exercises in a folder, in the course's order."""
    tasks = sorted((exercise.load(name, folder) for name in exercise.ids(folder)), key=lambda task: task.order)
    return [folder / task.id / task.notebook for task in tasks]


def _filled_in(text: str, root: Path, lists: dict[str, list[Path]]) -> str:
    for name, paths in lists.items():
        text = text.replace(f"{{{{ {name} }}}}", _as_documents(root, paths))
    return text


def _as_documents(root: Path, paths: Iterable[Path]) -> str:
    return "\n".join(path.relative_to(root).with_suffix("").as_posix() for path in paths)


def for_reading(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """A notebook as the site shows it: panels are pictures, answers folded, and links lead to the site's headings."""
    notebook.metadata.setdefault("language_info", {})["pygments_lexer"] = _LEXER
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            cell.source = _ANCHOR.sub(
                lambda found: found[1] + anchor(found[2]), _END_OF_FOLDED.sub("\n\n</details>", cell.source)
            )
        export.show_pictures(cell)
    return notebook


def anchor(heading: str) -> str:
    """A heading's anchor as GitHub and the site make it, out of JupyterLab's: `7.4-A-deadlock` is `74-a-deadlock`."""
    return re.sub(r"[^\w-]", "", heading).lower()


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")

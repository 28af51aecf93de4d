"""`course-kit dev site`: makes the site to read before installing, or to publish.

Sphinx's warnings are errors. Whatever is read is put into one folder, as it lies in the course's, for the links.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat

from course_kit import environment
from course_kit.dev import suite
from course_kit.grading.model.exercise import list_exercise_ids, load_exercise
from course_kit.integrations import export
from course_kit.ros2cli import parser as ros2_parser
from course_kit.text.console import refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

_USUAL = "artifacts/site"  # in the course's folder; git ignores it
_SIGN = ".buildinfo"  # Sphinx writes it into what it has made
NEEDS = ("sphinx", "myst_nb", "furo", "sphinx_argparse_cli")
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
)
_FOLDERS = ("course_kit/guides", "notebooks/pictures")
_LEXER = "lesson"  # see `conf`
_ANCHOR = re.compile(r"(\.ipynb#)([^)\s]+)")
_END_OF_FOLDED = re.compile(r"[ \t]*\n*</details>")


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when the site is there, 1 when Sphinx warned of something, 2 when it could not be tried."""
    parser = argparse.ArgumentParser(
        prog=f"{environment.course_command()} dev site", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument(
        "--to", type=Path, metavar="DIR", help=f"where it goes; left out, {_USUAL} in the course's folder"
    )
    options = parser.parse_args(arguments)
    root = environment.checkout_folder()
    if root is None:
        return refuse("the site is made of the course's folder. Run this in a clone of the course.")
    if not all(find_spec(name) for name in NEEDS):
        return refuse(
            'Sphinx and its extensions are missing. Run .venv/bin/python -m pip install -e ".[site]", then this again.'
        )
    target = (options.to or root / _USUAL).absolute()
    if _is_in_use(target):
        return refuse(f"{target} is no site that this command has made. Name a folder that is new or empty with --to.")
    return _build(root, target)


def _is_in_use(target: Path) -> bool:
    """Whether something else than a site lies there."""
    if not target.is_dir() or (target / ".git").exists():  # a file, or a checkout of a site that was published
        return os.path.lexists(target)
    return any(target.iterdir()) and not (target / _SIGN).is_file()


def _build(root: Path, target: Path) -> int:
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}-") as work:
        gathered, made = Path(work, "sources"), Path(work, "made")
        gather_pages(root, gathered)
        if code := _run_sphinx(gathered, made):
            return code
        if target.exists():
            shutil.rmtree(target)
        made.rename(target)
    print(f"course-kit: the site is there. Open {target / 'index.html'}")
    return 0


def _run_sphinx(gathered: Path, made: Path) -> int:
    """Its exit code: 0, or 1 after a warning or an error, which it has printed."""
    words = ["-b", "html", "-q", "-W", "--keep-going", "-j", "auto", "-c", str(Path(__file__).parent)]
    cached = ["-d", str(gathered.parent / "doctrees")]
    command = [sys.executable, "-m", "sphinx", *words, *cached, str(gathered), str(made)]
    return min(1, abs(subprocess.run(command, check=False).returncode))


def gather_pages(root: Path, folder: Path) -> None:
    """Put together what Sphinx reads in an empty folder."""
    own = folder / "exercises"
    for name in _FOLDERS:
        shutil.copytree(root / name, folder / name)
    for page in [*(root / name for name in _MARKDOWN), *(root / "notebooks").glob("*.md")]:
        _write(folder / page.relative_to(root), page.read_text(encoding="utf-8"))
    _write(folder / "index.md", (root / "README.md").read_text("utf-8") + (_PAGES / _FRONT_END).read_text("utf-8"))
    lists = {"exercises": _in_order(root / own.name), "drills": _in_order(root / own.name / "drills")}
    for page in sorted(_PAGES.rglob("*.md")):
        if page.name != _FRONT_END:
            _write(folder / page.relative_to(_PAGES), _filled_in(page.read_text("utf-8"), root, lists))
    for path in [*suite.list_with_outputs(root, drills=False), *lists["exercises"], *lists["drills"]]:
        _write(folder / path.relative_to(root), nbformat.writes(for_reading(nbformat.read(path, as_version=4))))


def _in_order(folder: Path) -> list[Path]:
    """The notebooks of the exercises in a folder, in the course's order."""
    exercises = (load_exercise(name, folder) for name in list_exercise_ids(folder))
    return [exercise.folder / exercise.notebook for exercise in sorted(exercises, key=lambda exercise: exercise.order)]


def _filled_in(text: str, root: Path, lists: dict[str, list[Path]]) -> str:
    for name, paths in lists.items():
        documents = (path.relative_to(root).with_suffix("").as_posix() for path in paths)
        text = text.replace(f"{{{{ {name} }}}}", "\n".join(documents))
    return text


def for_reading(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """A notebook as the site shows it: panels are pictures, answers folded, and links lead to the site's headings."""
    notebook.metadata.setdefault("language_info", {})["pygments_lexer"] = _LEXER
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            cell.source = _ANCHOR.sub(
                lambda found: found[1] + heading_anchor(found[2]), _END_OF_FOLDED.sub("\n\n</details>", cell.source)
            )
        export.show_pictures(cell)
    return notebook


def heading_anchor(heading: str) -> str:
    """A heading's anchor as GitHub and the site make it, out of JupyterLab's: `7.4-A-deadlock` is `74-a-deadlock`."""
    return re.sub(r"[^\w-]", "", heading).lower()


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def ros2_parser_with_all() -> ros2_parser.Parser:
    """The parser of `ros2` with the verbs of all commands; a command line that is run has only those it needs."""
    return ros2_parser.build_parser(list(ros2_parser.COMMANDS))

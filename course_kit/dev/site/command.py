"""`course-kit dev site`: makes the site to read before installing, or to publish.

Whatever Sphinx warns of is an error. The pages need no network and fetch nothing from another host. The folder is
replaced only by a site that is complete.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.dev.site import sources
from course_kit.grading import GradingError
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Sequence

_USUAL = "artifacts/site"  # in the course's folder; git ignores it
_SIGN = ".buildinfo"  # Sphinx writes it into what it has made
NEEDS = ("sphinx", "myst_nb", "furo", "sphinx_argparse_cli")


def main(arguments: Sequence[str]) -> int:
    """The command: 0 when the site is there, 1 when Sphinx warned of something, 2 when it could not be tried."""
    parser = argparse.ArgumentParser(prog="course-kit dev site", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument(
        "--to", type=Path, metavar="DIR", help=f"where it goes; left out, {_USUAL} in the course's folder"
    )
    options = parser.parse_args(arguments)
    root = environment.checkout()
    if root is None:
        return cannot("the site is made of the course's folder. Run this in a clone of the course.")
    if not all(find_spec(name) for name in NEEDS):
        return cannot(
            'Sphinx and its extensions are missing. Run .venv/bin/python -m pip install -e ".[site]", then this again.'
        )
    target = (options.to or root / _USUAL).absolute()
    if _is_in_use(target):
        return cannot(f"{target} is no site that this command has made. Name a folder that is new or empty with --to.")
    try:
        return _build(root, target)
    except GradingError as problem:
        return cannot(problem)
    except OSError as problem:
        return cannot(f"the site cannot be written: {problem}.")


def _is_in_use(target: Path) -> bool:
    """Whether something else than a site lies there."""
    if not target.is_dir():
        return target.exists() or target.is_symlink()
    if (target / ".git").exists():  # a checkout of a site that was published: making one would remove the folder
        return True
    return any(target.iterdir()) and not (target / _SIGN).is_file()


def _build(root: Path, target: Path) -> int:
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=f".{target.name}-") as work:
        gathered, made = Path(work, "sources"), Path(work, "made")
        sources.gather(root, gathered)
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

"""A learner's folder: lessons and exercises to work in, copied from a course once, and new versions of them later.

A manifest in it says what was handed out. A new version takes the place of what the learner has not changed, and is
laid beside what they have. What they have deleted, and what the course no longer has, stays as it is.
"""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

BESIDE = "new-version"
_FORMAT_VERSION = 1
_NOTEBOOK = ".ipynb"


def update(folder: Path, course: Mapping[str, bytes], *, restore: bool = False) -> list[str]:
    """Make a learner's folder, or bring new versions into it; returns what to tell the learner."""
    known = _read_manifest(folder)
    renewed: list[str] = []
    beside: list[str] = []
    handed_out = {path: digest(path, content) for path, content in course.items()}
    for path, content in course.items():
        file, new, given = folder / path, handed_out[path], known.get(path)
        theirs = _digest_of(file)
        is_missing = theirs is None and (restore or given != new)
        if is_missing or (theirs == given and new != given):
            environment.write_atomically(file, content, durable=not is_missing)
            renewed += [path] if given not in (None, new) else []
        elif theirs not in (None, new) and new != given:
            beside.append(f"{path} as {_lay_beside(file, content)}")
    if (now := {**known, **handed_out}) != known:
        manifest = {"format_version": _FORMAT_VERSION, "handed_out": now}
        environment.write_atomically(folder / environment.paths.MANIFEST, f"{json.dumps(manifest, indent=1)}\n")
    told = [f"New version of {', '.join(renewed)}; you had not changed the old one."] if renewed else []
    if beside:
        told.append(
            f"You have changed files that have a new version. Yours stay; the new version of {', '.join(beside)}."
        )
    return told


def as_handed_out(name: str, content: bytes) -> bytes:
    """A file of the course as a learner gets it: a notebook opens without outputs, which would tell what comes."""
    notebook = _notebook(name, content)
    if notebook is None:
        return content
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            cell["outputs"], cell["execution_count"] = [], None
    notebook.setdefault("metadata", {})["language_info"] = language_info()
    return f"{json.dumps(notebook, indent=1, ensure_ascii=False)}\n".encode()


def language_info() -> dict[str, Any]:
    """What a kernel says of its language: JupyterLab writes it into each notebook, and then calls it unsaved."""
    from ipykernel.ipkernel import IPythonKernel

    return dict(IPythonKernel.language_info)


def digest(name: str, content: bytes) -> str:
    """What a learner has written in a file, as a hash: of a notebook its cells, whatever their outputs are."""
    if (notebook := _notebook(name, content)) is not None:
        cells = [[cell["cell_type"], "".join(cell.get("source", ""))] for cell in notebook["cells"]]
        content = json.dumps(cells).encode()
    return hashlib.sha256(content).hexdigest()


def _digest_of(path: Path) -> str | None:
    """The hash of a file; None where there is none, and "" for what cannot be read, such as a folder: nobody's hash."""
    try:
        return digest(path.name, path.read_bytes())
    except FileNotFoundError:
        return None
    except (IsADirectoryError, PermissionError):
        return ""


def _lay_beside(file: Path, content: bytes) -> str:
    """Write a new version beside a learner's file; returns its name. Another one that they changed stays, too."""
    number, name = 1, f"{file.stem}.{BESIDE}{file.suffix}"
    while _digest_of(file.with_name(name)) not in (None, digest(name, content)):
        number += 1
        name = f"{file.stem}.{BESIDE}-{number}{file.suffix}"
    environment.write_atomically(file.with_name(name), content)
    return name


def _read_manifest(folder: Path) -> dict[str, str]:
    """By path the hash of what was handed out; empty where nobody knows."""
    try:
        found = json.loads((folder / environment.paths.MANIFEST).read_bytes())["handed_out"]
        return {str(path): str(value) for path, value in found.items()}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}


def _notebook(name: str, content: bytes) -> dict[str, Any] | None:
    """A notebook's content; None for anything else, a damaged one too."""
    if not name.endswith(_NOTEBOOK):
        return None
    try:
        found: dict[str, Any] = json.loads(content)
        whole = all(isinstance(cell["cell_type"], str) for cell in found["cells"])
    except (ValueError, KeyError, TypeError, RecursionError):
        return None
    return found if whole and isinstance(found.get("metadata", {}), dict) else None

"""The notebook of this kernel, as it was last saved."""

from __future__ import annotations

import json
import os
import re
from functools import lru_cache
from pathlib import Path

_ELSEWHERE = re.compile(r"%%(?!submission\b|time\b|interface\b)")  # how a cell begins that is a program


def defining_line(name: str, failed: str) -> str:
    """How a line begins that defines a name in another cell than the one that failed; "" where none does.

    Of an import it is one for this name alone. The notebook is taken as it was last saved.
    """
    assigns = rf"(?:\w+, *)*{name}(?:, *\w+)* *=[^=]"
    defines = re.compile(
        rf"^(?:(?:async )?def {name}\b|class {name}\b|{assigns}|(?:from \S+ )?import .*\b{name}\b)", re.MULTILINE
    )
    cells = [source for source in saved_cells()[0].values() if not _ELSEWHERE.match(source)]
    found = (defines.search(source) for source in cells if source.strip() != failed.strip())
    line = next((match[0] for match in found if match), "")
    return re.sub(rf"^(from \S+ import) .*\b{name}$", rf"\1 {name}", line) if " as " not in line else line


def notebook_path() -> Path:
    """Where this kernel's notebook lies, as Jupyter says it; empty where nobody says it."""
    return Path(os.environ.get("JPY_SESSION_NAME", ""))


def saved_cells() -> tuple[dict[str, str], float]:
    """Its code cells by their ids, and when it was saved; none if no such file is there, or one half written."""
    path = notebook_path()
    try:
        saved_s = path.stat().st_mtime
        return _read_cells(path, saved_s), saved_s
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return {}, 0.0


@lru_cache(maxsize=1)
def _read_cells(path: Path, saved_s: float) -> dict[str, str]:
    del saved_s  # which version of the file it is
    cells = [cell for cell in json.loads(path.read_bytes())["cells"] if cell["cell_type"] == "code"]
    return {cell.get("id", f"#{place}"): "".join(cell["source"]) for place, cell in enumerate(cells)}

"""What an export of a notebook by nbconvert needs besides nbconvert, be it HTML or slides.

`jupyter_config/jupyter_nbconvert_config.json` has it run for `jupyter nbconvert`; Jupyter Server, which does not read
that file, gets the same from its extension, for JupyterLab's File > Save and Export Notebook As.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from nbconvert.filters.markdown import markdown2html
from nbconvert.preprocessors import Preprocessor

if TYPE_CHECKING:
    from nbformat import NotebookNode

_WIDGET = "application/vnd.jupyter.widget-view+json"
_FOLDED = re.compile(r"^<details>\s*(<summary>.*?</summary>)\n(.*?)</details>", re.DOTALL | re.MULTILINE)
_EMPTY_LINES = re.compile(r"\n(?:[ \t]*\n)+")


class StillAndFolded(Preprocessor):
    """Keeps answers folded, and has a picture of each panel take the widget's place."""

    def preprocess_cell(
        self, cell: NotebookNode, resources: dict[str, Any], _index: int
    ) -> tuple[NotebookNode, dict[str, Any]]:
        """Called by nbconvert for each cell."""
        if cell.cell_type == "markdown":
            # Each `<details>` becomes a single piece of HTML, which nothing can close too early.
            cell.source = _FOLDED.sub(_in_one_piece, cell.source)
        show_pictures(cell)
        return cell, resources


def show_pictures(cell: NotebookNode) -> None:
    """Have the pictures of a cell's panels take the places of their widgets, which are nothing without a kernel."""
    for output in cell.get("outputs", []):
        data = output.get("data", {})
        if "text/html" in data:
            data.pop(_WIDGET, None)


def _in_one_piece(found: re.Match[str]) -> str:
    html = str(markdown2html(found[2])).strip()
    inside = _EMPTY_LINES.sub(lambda lines: "&#10;" * lines[0].count("\n"), html)  # programs have some
    return f"<details>{found[1]}\n{inside}\n</details>\n"

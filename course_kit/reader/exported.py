"""What Jupyter has made of a notebook that somebody exported as a Python script.

`%%submission` is a cell magic, which such a script has as a call, `get_ipython().run_cell_magic("submission", ...)`.
"""

from __future__ import annotations

import ast
import re
from bisect import bisect

from course_kit.reader import python

_CALL = "run_cell_magic"
_MAGIC = "submission"
_PARTS = 3  # of the call: the magic's name, its line, its cell
_NUMBER = re.compile(r"# In\s*\[(\d{1,6})\]:")


def cells(source: str) -> list[tuple[int, str]]:
    """Number and text of each cell with a `%%submission`, as they stood in the notebook; none in other programs."""
    if _CALL not in source:
        return []
    try:
        _, tree = python.parse(source)
    except python.TooMuchError:
        return []  # whoever reads it as a program says so
    numbers = _numbers(source)
    lines = [line for line, _ in numbers]
    found = []
    for node in tree.body if tree else ():
        parts = _parts(node)
        if parts is not None and parts[0] == _MAGIC:
            place = bisect(lines, node.lineno)
            found.append((numbers[place - 1][1] if place else 1, f"%%{_MAGIC} {parts[1]}\n{parts[2]}"))
    return found


def _parts(node: ast.stmt) -> list[str] | None:
    """The arguments of a statement that calls a cell magic."""
    if not (isinstance(node, ast.Expr) and isinstance(node.value, ast.Call)):
        return None
    call = node.value
    if not (isinstance(call.func, ast.Attribute) and call.func.attr == _CALL):
        return None
    parts = [one.value for one in call.args if isinstance(one, ast.Constant) and isinstance(one.value, str)]
    return parts if len(parts) == _PARTS else None


def _numbers(source: str) -> list[tuple[int, int]]:
    """Line and number of each comment `# In[3]:`, which stands above the cell of this number."""
    matches = ((number, _NUMBER.match(line)) for number, line in enumerate(source.split("\n"), start=1))
    return [(number, int(match[1])) for number, match in matches if match]

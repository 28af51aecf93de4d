"""Colours of a lesson's cells: Python, lines for IPython or a shell, and the programs below the course's magics."""

from __future__ import annotations

from typing import Any, ClassVar

from pygments.lexer import bygroups, inherit, using
from pygments.lexers.python import PythonLexer
from pygments.token import Keyword, Operator, Text


class LessonLexer(PythonLexer):
    """Python with magics; IPython's own lexer does not know the course's, and has no colours below them."""

    name = "a lesson of the course"
    aliases: ClassVar[list[str]] = ["lesson"]
    tokens: ClassVar[dict[str, list[Any]]] = {
        "root": [
            (
                r"(?s)(%%)(submission|ros_script)([^\n]*\n)(.*)",
                bygroups(Operator, Keyword, Text, using(PythonLexer)),
            ),
            (r"(?s)(%%)(\w+)(.*)", bygroups(Operator, Keyword, Text)),
            (r"^([%!])(\w+)([^\n]*\n)", bygroups(Operator, Keyword, Text)),
            inherit,
        ],
    }

"""How Sphinx makes the site out of what `command` has put together."""

from __future__ import annotations

from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pygments.lexer import bygroups, inherit, using
from pygments.lexers.python import PythonLexer
from pygments.token import Keyword, Operator, Text

if TYPE_CHECKING:
    from sphinx.application import Sphinx

project = "ROS 2 course kit"
author = "the maintainers of the ROS 2 course kit"
project_copyright = "the maintainers of the ROS 2 course kit. Apache-2.0"
version = release = metadata.version("ros2-course-kit")

extensions = [
    "myst_nb",  # notebooks and Markdown
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_argparse_cli",
]
exclude_patterns: list[str] = []

nb_execution_mode = "off"  # what the notebooks show is stored with them
nb_merge_streams = True  # one cell's prints may be stored in pieces
myst_heading_anchors = 4  # as GitHub makes them

default_role = "literal"  # docstrings quote code with single backticks
highlight_language = "none"  # where a block does not say, it is a terminal
smartquotes = False  # texts stay as they are written: two hyphens begin an option
napoleon_numpy_docstring = False

html_theme = "furo"
html_title = project
html_static_path = [str(Path(__file__).parent / "static")]
html_css_files = ["custom.css"]  # a name that sphinx-argparse-cli asks for, too, in its last version for Python 3.10
html_js_files = ["site.js"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}


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


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.add_lexer(LessonLexer.aliases[0], LessonLexer)

"""HTML and SVG out of template files. Whatever is filled in is made printable and escaped, without being asked for it.

Jinja2 is loaded when something is first rendered: most who grade or teach render nothing.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from course_kit.text.sanitize import make_printable

if TYPE_CHECKING:
    from pathlib import Path

    from jinja2 import Environment
    from markupsafe import Markup


def render_template(template: Path, **values: object) -> Markup:
    """A template with its values filled in; other templates take the result as it is."""
    from markupsafe import Markup

    return Markup(_environment(template.parent).get_template(template.name).render(values))  # noqa: S704 - it escapes


@cache  # one for each folder of templates, of which there are few
def _environment(folder: Path) -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from markupsafe import Markup, escape  # in C: a class run fills in a hundred thousand values

    def filled_in(value: object) -> Markup:
        """A value as a page shows it: HTML of other templates as it is, everything else as text."""
        return value if isinstance(value, Markup) else escape(make_printable(str(value)))

    return Environment(
        loader=FileSystemLoader(folder),
        autoescape=True,
        finalize=filled_in,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,  # a class run renders thousands of reports
    )

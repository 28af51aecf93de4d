"""A panel as a still picture, for exports of a notebook: it needs no kernel, no script, nothing that is fetched."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from course_kit.text.templates import render

_HERE = Path(__file__).parent


def still(words: str, picture: str = "", *style_sheets: str) -> str:
    """The HTML of a still picture."""
    sheets = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("still.css", *style_sheets))
    return str(render(_HERE / "still.html", css=_as_it_is(sheets), picture=picture, lines=words.splitlines()))


def drawn(template: str, **values: object) -> str:
    """A picture out of a template of this folder."""
    return render(_HERE / template, **values)


def form(title: dict[str, str], part: str, entries: list[dict[str, Any]], values: dict[str, Any], *buttons: str) -> str:
    """A form that sends a message, as a picture; its style sheet is `still_panels.css`."""
    return drawn("still_form.html", **title, part=part, entries=entries, values=values, buttons=buttons)


def _as_it_is(sheet: str) -> str:
    from markupsafe import Markup

    short = " ".join(re.sub(r"/\*.*?\*/", "", sheet, flags=re.DOTALL).split())  # it is stored with each picture
    return Markup(short)  # noqa: S704 - files of ours

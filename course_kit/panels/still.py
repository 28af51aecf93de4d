"""A panel as a still picture, for exports of a notebook: it needs no kernel, no script, nothing that is fetched."""

from __future__ import annotations

from pathlib import Path

from course_kit.text.templates import render

_HERE = Path(__file__).parent


def still(words: str, picture: str = "", *style_sheets: str) -> str:
    """The HTML of a still picture.

    Args:
        words: the panel in words, which stand below the picture, or in its place.
        picture: HTML or SVG that a template has rendered.
        style_sheets: files of this folder that the picture needs.
    """
    sheets = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("still.css", *style_sheets))
    return str(render(_HERE / "still.html", css=_as_it_is(sheets), picture=picture, lines=words.splitlines()))


def _as_it_is(sheet: str) -> str:
    from markupsafe import Markup

    return Markup(sheet)  # noqa: S704 - a file of ours

"""Templates: what is filled in is harmless without being asked for it, and what is missing is an error."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from jinja2 import UndefinedError

from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from pathlib import Path

WILD = "<script>'\"&\x1b[2J\u202e\r\n👩\u200d👧"
HARMLESS = "&lt;script&gt;&#39;&#34;&amp;\ufffd[2J\ufffd\n👩\u200d👧"


def written(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "page"


@pytest.mark.parametrize(
    "template",
    [
        "{{ wild }}",
        "{{ wild ~ '' }}",
        "{% set kept = wild %}{{ kept }}",
        "{% macro told(text) %}{{ text }}{% endmacro %}{{ told(wild) }}",
        "{% macro told() %}{{ caller() }}{% endmacro %}{% call told() %}{{ wild }}{% endcall %}",
        "{% include 'part' %}",
        "{% from 'macros' import told %}{{ told(wild) }}",
        "{{ [wild]|join(', ') }}",
        "{{ {'text': wild}['text'] }}",
    ],
)
def test_what_is_filled_in_is_harmless(tmp_path: Path, template: str) -> None:
    macros = "{% macro told(text) %}{{ text }}{% endmacro %}"
    page = written(tmp_path, page=template, part="{{ wild }}", macros=macros)
    assert render_template(page, wild=WILD) == HARMLESS


@pytest.mark.parametrize("template", ["{{ missing }}", "{{ known.missing }}"])
def test_what_is_missing_is_an_error(tmp_path: Path, template: str) -> None:
    with pytest.raises(UndefinedError):
        render_template(written(tmp_path, page=template), known="")


@pytest.mark.parametrize("module", ["course_kit.grading", "course_kit.classroom.exports", "course_kit.quiz"])
def test_jinja_is_loaded_only_when_something_is_rendered(module: str) -> None:
    program = f"import sys, {module}; sys.exit('jinja2' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0

"""The page with all kinds of declared checks says what is so."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest

from course_kit.grading import exercise
from course_kit.grading.checks.declared import kinds
from tests.grading.checks.declared.conftest import HEAD, HINTS, written
from tests.grading.conftest import ROOT

if TYPE_CHECKING:
    from pathlib import Path

PAGE = (ROOT / "course_kit" / "authoring" / "CHECKS.md").read_text(encoding="utf-8")
SECTIONS = {one.partition("\n")[0]: one for one in PAGE.split("\n## ")[1:]}
EXAMPLES = {name: re.findall(r"```toml\n(.*?)```", text, re.DOTALL) for name, text in SECTIONS.items()}
ENDPOINTS = re.findall(r"```toml\n(.*?)```", PAGE.split("\n## ")[0], re.DOTALL)[0]


def test_there_is_a_section_for_each_kind() -> None:
    assert list(SECTIONS)[1:] == list(kinds.KINDS)


@pytest.mark.parametrize("name", kinds.KINDS)
def test_every_key_of_a_kind_is_explained(name: str) -> None:
    tables = [{"kind": name, key: 1} for key in ("", "requests", "messages")]
    keys = {key for table in tables for key in kinds.kind_of(table).keys}
    assert [key for key in sorted(keys) if f"`{key}" not in SECTIONS[name]] == []


@pytest.mark.parametrize("name", kinds.KINDS)
def test_the_example_of_a_kind_is_loaded(tmp_path: Path, name: str) -> None:
    (example,) = EXAMPLES[name]
    path = written(tmp_path, "")
    path.write_text(HEAD.replace("{points}", "1.0") + ENDPOINTS + example + HINTS)
    (check,) = exercise.load("all_kinds", path.parent.parent).declared
    assert check.kind == name


def test_all_examples_make_one_exercise(tmp_path: Path) -> None:
    path = written(tmp_path, "")
    examples = "\n".join(one for name in kinds.KINDS for one in EXAMPLES[name])
    path.write_text(HEAD.replace("{points}", f"{len(kinds.KINDS)}.0") + ENDPOINTS + examples + HINTS)
    assert [one.kind for one in exercise.load("all_kinds", path.parent.parent).declared] == list(kinds.KINDS)

"""Guides, questions and code have short sentences and plain words; those in the lists made readers stumble."""

from __future__ import annotations

import re
import sys
import tokenize
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Iterator

REPOSITORY = Path(__file__).resolve().parent.parent.parent
FOLDERS = (
    ".",
    "notebooks",
    *(f"course_kit/{name}" for name in ("guides", "authoring", "classroom", "grading")),
)
OLD = {"CHANGELOG.md", "CODE_OF_CONDUCT.md"}  # of before, and somebody else's words
GUIDES = [path for folder in FOLDERS for path in sorted((REPOSITORY / folder).glob("*.md")) if path.name not in OLD]
MOST_WORDS = 28
EXCEPTIONS: tuple[str, ...] = ()  # beginnings of longer sentences that stay
STUMBLES = re.compile(
    r"\b(mend(s|ed)|told|in force|there is none|how manieth|nothing else than|of (its|their) own|to be had|"
    r"counts? for nothing|(is|are) to be|(is|are) another one|there already|came? to an end|something is odd|any more|"
    r"as it stands|when what|says who|no matter|shall|so long|only so|the other way round)\b",
    re.IGNORECASE,
)

IN_CODE = re.compile(  # docstrings, comments and messages; a name in backquotes is none of them
    r"(?<!`)\b(mend(s|ed)|told(?! apart)|in force|there is none|how manieth|nothing else than|of (its|their) own|"
    r"to be had|counts? for nothing|(is|are) to be|(is|are) another one|there already|came? to an end|when what|"
    r"says who|only so)\b",
    re.IGNORECASE,
)
# Questions, tasks, hints, diagnoses, and the reasons given in proofs.
TEXT_FOLDERS = ("course_kit", "exercises", "solutions", "tests/authoring", "tests/proof", "tests/slips")
TABLES = [path for folder in TEXT_FOLDERS for path in sorted((REPOSITORY / folder).rglob("*.toml"))]
CODE = {"old", "new", "lines"}  # the keys whose values are programs' lines
PACKAGES = sorted(path.parent for path in (REPOSITORY / "course_kit").glob("*/__init__.py"))


def sentences(text: str) -> list[str]:
    """Without code; a cell of a table, an item of a list and a heading end a sentence, too."""
    text = re.sub(r"^ *(`{3,}).*?^ *\1", "\n\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)|<[^>]*>", "]", re.sub(r"`[^`]*`", "`code`", text))
    parts = re.split(r"(?<=[.!?])[*)\"]*\s+|\n\s*\n|\n(?=\s*(?:[-#|>]|\d+\.) ?)|\|", text)
    return [" ".join(part.split()) for part in parts]


def read_texts(value: Any) -> Iterator[str]:
    """The texts in a table or list, without code."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, (dict, list)):
        parts = [part for key, part in value.items() if key not in CODE] if isinstance(value, dict) else value
        for part in parts:
            yield from read_texts(part)


def read_comments(text: str) -> str:
    return re.sub(r"^(?!#).*|^# ?", "", text, flags=re.MULTILINE)


@pytest.mark.parametrize("path", [*GUIDES, *TABLES], ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_its_sentences_are_short_and_plain(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    parts = [text] if path.suffix == ".md" else [read_comments(text), *read_texts(tomllib.loads(text))]
    found = [one for part in parts for one in sentences(part)]
    assert found
    assert [one for one in found if len(one.split()) > MOST_WORDS and not one.startswith(EXCEPTIONS)] == []
    assert [(word[0], one) for one in found if (word := STUMBLES.search(one))] == []


def test_each_file_that_contributing_names_is_there() -> None:
    named = set(re.findall(r"`([\w/]+/\w+\.py)`", (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")))
    around = [REPOSITORY / folder for folder in (".", "course_kit", "course_kit/grading", "tests", "tests/grading")]
    assert len(named) > 20
    assert [one for one in sorted(named) if not any((folder / one).exists() for folder in around)] == []


@pytest.mark.parametrize("package", [*PACKAGES, REPOSITORY / "course_setup"], ids=lambda path: path.name)
def test_its_docstrings_comments_and_messages_are_plain(package: Path) -> None:
    found = []
    for path in package.rglob("*.py"):
        with path.open("rb") as file:
            words = [token for token in tokenize.tokenize(file.readline) if " " in token.string]
        assert words or not path.stat().st_size, path
        found += [(path.name, token.start[0], hit[0]) for token in words if (hit := IN_CODE.search(token.string))]
    assert found == []

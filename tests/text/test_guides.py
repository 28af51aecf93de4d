"""Guides have short sentences and plain words, code plain words; those in the lists are what readers stumbled over."""

from __future__ import annotations

import re
import tokenize
from pathlib import Path

import pytest

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
PACKAGES = sorted(path.parent for path in (REPOSITORY / "course_kit").glob("*/__init__.py"))


def sentences(text: str) -> list[str]:
    """Without code; a cell of a table, an item of a list and a heading end a sentence, too."""
    text = re.sub(r"^ *(`{3,}).*?^ *\1", "\n\n", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)|<[^>]*>", "]", re.sub(r"`[^`]*`", "`code`", text))
    parts = re.split(r"(?<=[.!?])[*)\"]*\s+|\n\s*\n|\n(?=\s*(?:[-#|>]|\d+\.) ?)|\|", text)
    return [" ".join(part.split()) for part in parts]


@pytest.mark.parametrize("path", GUIDES, ids=lambda path: str(path.relative_to(REPOSITORY)))
def test_its_sentences_are_short_and_plain(path: Path) -> None:
    found = sentences(path.read_text(encoding="utf-8"))
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

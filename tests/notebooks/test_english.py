"""Phrases that follow another language's word order, over which a native reader stumbles."""

from __future__ import annotations

import ast
import re
from pathlib import Path
from typing import TYPE_CHECKING

import nbformat
import pytest

from tests.notebooks.test_form import EXERCISES, LESSONS
from tests.text.test_guides import MOST_WORDS, sentences

if TYPE_CHECKING:
    from collections.abc import Iterator

REPOSITORY = Path(__file__).resolve().parent.parent.parent
EDITED = [  # texts in TOML that learners read
    REPOSITORY / "course_kit/grading/diagnosis/diagnoses.toml",
    *sorted((REPOSITORY / "exercises").rglob("exercise.toml")),
    *sorted((REPOSITORY / "course_kit/quiz/data").rglob("*.toml")),
]
STUMBLES = {
    r"so long (the|that is)": "say 'that is how long'",
    r"only so (you|it|we)": "say 'that is how'",
    r"the other way round": "say what the other way is",
    r"programs? of (its|their|your|my) own": "say 'a separate program', or 'your own program'",
    r"nodes? of your own": "say 'your own node'",
    r"has no say": "say 'makes no difference'",
    r"what has to be (changed|done)": "say 'what has to change', or who does it",
    r"what has (an?|the) \w+": "a question needs 'does ... have'",
    r"which \w+ \w+ has (an?|the)\b": "a question needs 'does ... have'",
    r"to the letter": "say 'exactly'",
    r"slips? of the pen": "say 'misspelt'",
    r"so to speak": "say what is meant",
    r"never heard of": "say 'does not know'",
    r"what becomes of": "say 'what happens to'",
    r"\bwe shall\b": "the reader does it: say 'you', or use the present",
    r"say(s|ing)? `result_timeout`": "the subject comes before the verb",
    r"half a minute after .*, so": "say when it was",
    r"(process|graph|cell|thread|group|folder|copy|seed|number)(es|s)? of (its|their|your|my) own": "say 'its own ...'",
    r"\bone (hint|goal|message|request|step) more\b": "say 'one more ...'",
    r"\bfor (each|every) [^.:;]{1,40} comes (one|an?)\b": "say 'each ... brings one'",
    r"\bshall\b": "say 'should', 'must', or use the present",
    r"counts? for nothing": "say 'earns no points'",
    r"to be rid of": "say 'to remove'",
    r"\b(is|are) (expected|found out|left aside)\.": "say who expects or finds it",
    r"(is|are) not there any more": "say 'no longer there'",
    r"\bstands? (no|nothing|nobody)\b": "say 'there is no'",
    r"\bwhom its\b": "say it as two clauses",
    r"\bin force\b": "say what holds, or which value a node has",
    r"\bmend(s|ed)\b": "say 'repair'",
    r"how manieth": "say 'which', counting from what",
    r"(is|are) to be (seen|done|had|asked|given|sent|used)\b": "say who does it",
    r"on a line of its own": "say 'on a separate line'",
    r"nothing else than": "say 'only'",
}
LONG = ("**Further reading**", "Then the server sends feedback: 0, 1, 1; then", "- **For each of your ten scenarios**")
# Packages whose messages learners read.
SPEAKING = ("authoring", "classroom", "cli", "environment", "graders", "grading", "integrations", "interfaces", "lab")
SPEAKING += ("launch", "learner", "panels", "presentation", "quiz", "ros", "ros2cli")


def prose(path: Path) -> str:
    if path.suffix == ".ipynb":
        return "\n".join(c.source for c in nbformat.read(path, as_version=4).cells if c.cell_type == "markdown")
    return path.read_text(encoding="utf-8")


def stumbles(text: str) -> dict[str, str]:
    """What a reader stumbles over, with a few words around it, and what to do about it."""
    text = " ".join(text.split())
    return {
        text[max(0, hit.start() - 40) : hit.end() + 20]: why
        for phrase, why in STUMBLES.items()
        for hit in re.finditer(phrase, text, re.IGNORECASE)
    }


def messages(path: Path) -> Iterator[str]:
    """The strings of a module, without its docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in alone:
            yield node.value
        elif isinstance(node, ast.JoinedStr):
            yield "".join(str(part.value) if isinstance(part, ast.Constant) else "X" for part in node.values)


@pytest.mark.parametrize("package", SPEAKING)
def test_its_messages_are_in_english_word_order(package: str) -> None:
    paths = sorted((REPOSITORY / "course_kit" / package).rglob("*.py"))
    assert paths
    assert not stumbles("\n".join(text for path in paths for text in messages(path)))


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES, *EDITED], ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_its_sentences_are_in_english_word_order(path: Path) -> None:
    assert not stumbles(prose(path))


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES], ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_its_sentences_are_short(path: Path) -> None:
    cells = (cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "markdown")
    found = [one for cell in cells for one in sentences(cell)]
    assert found
    assert [one for one in found if len(one.split()) > MOST_WORDS and not one.startswith(LONG)] == []

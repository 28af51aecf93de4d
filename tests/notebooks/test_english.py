"""Phrases that follow another language's word order, over which a native reader stumbles."""

from __future__ import annotations

import re
from pathlib import Path

import nbformat
import pytest

from tests.notebooks.test_form import EXERCISES, LESSONS

REPOSITORY = Path(__file__).resolve().parent.parent.parent
EDITED = [  # texts in TOML that learners read
    REPOSITORY / "course_kit/grading/diagnosis/diagnoses.toml",
    *sorted((REPOSITORY / "exercises").rglob("exercise.toml")),
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
}


def prose(path: Path) -> str:
    if path.suffix == ".ipynb":
        return "\n".join(c.source for c in nbformat.read(path, as_version=4).cells if c.cell_type == "markdown")
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", [*LESSONS, *EXERCISES, *EDITED], ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_its_sentences_are_in_english_word_order(path: Path) -> None:
    text = " ".join(prose(path).split())
    found = {
        text[max(0, hit.start() - 40) : hit.end() + 20]: why
        for phrase, why in STUMBLES.items()
        for hit in re.finditer(phrase, text, re.IGNORECASE)
    }
    assert not found

"""No sentence stands twice in the code of the checks."""

from __future__ import annotations

import ast
from collections import Counter
from pathlib import Path

import course_kit.grading.checks
from course_kit.graders import temperature_service

SENTENCE = 40  # characters; what is shorter may be a phrase that several sentences need
SOURCES = [*Path(course_kit.grading.checks.__file__).parent.glob("*.py"), Path(temperature_service.__file__)]


def _texts(tree: ast.AST) -> list[str]:
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value.strip()
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings
    ]


def test_no_sentence_stands_twice_in_the_checks() -> None:
    texts = Counter(text for source in SOURCES for text in _texts(ast.parse(source.read_text(encoding="utf-8"))))
    assert [text for text, times in texts.items() if times > 1 and len(text) > SENTENCE] == []

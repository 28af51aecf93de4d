"""A tiny exercise without ROS, whose grader the tests write: a dictionary `limits` with two numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring.prove import proving
from course_kit.grading.model.exercise import Exercise, load_exercise

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.authoring.prove.proving import GraderProof

SOLUTION = 'limits = {\n    "low": 2,\n    "high": 5,\n}\n'
_TOML = """
format_version = 1
id = "tiny"
title = "Two limits"
order = 9
points = 2.0
pass_mark = 1.0
starter = "tiny.py"
notebook = "tiny.ipynb"
grader = "checks.py"
variable = "limits"
seed = 1

[[sentences]]
id = "low_is_two"
text = "The low limit is 2."

[[sentences]]
id = "high_is_five"
text = "The high limit is 5."
"""
_GRADER = '''
from pathlib import Path

from course_kit.grading.checks.vocabulary import Evidence, Failed, check
from course_kit.quiz import read_answers

HERE = Path(__file__).parent


def limits(node):
    """What the submission has set, by name."""
    context = node.context
    if context.job.text.literal is not None:
        return read_answers(context.job.text.literal["entries"])
    return read_answers(context.run_to_end().notes["entries"])


@check(points=1.0, proves=["low_is_two"])
def low(node):
    """The low limit is right."""
    got = limits(node).get("low")
    if not ({low}):
        raise Failed(Evidence("", "2", str(got)), "It is not 2.")


@check(points=1.0, proves=["high_is_five"])
def high(node):
    """The high limit is right."""
    got = limits(node).get("high")
    if not ({high}):
        raise Failed(Evidence("", "5", str(got)), "It is not 5.")


CHECKS = (low, high)
'''


@dataclass
class Tiny:
    """The exercise in a folder of its own, outside of the checkout."""

    folder: Path

    def grader(self, low: str = "got == 2", high: str = "got == 5") -> None:
        """Write its grader: what of `got` each check takes for right."""
        (self.folder / "exercises" / "tiny" / "checks.py").write_text(
            _GRADER.replace("{low}", low).replace("{high}", high)
        )

    @property
    def exercise(self) -> Exercise:
        return load_exercise("tiny", self.folder / "exercises")

    def declare(self, text: str) -> None:
        (self.exercise.solution.parent / proving.FILE).write_text(text)

    def prove(self) -> GraderProof:
        return proving.prove_grader(self.exercise, workers=1)


@pytest.fixture
def tiny(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Tiny:
    made = Tiny(tmp_path)
    (tmp_path / "exercises" / "tiny").mkdir(parents=True)
    (tmp_path / "exercises" / "tiny" / "exercise.toml").write_text(_TOML)
    made.grader()
    made.exercise.solution.parent.mkdir(parents=True)
    made.exercise.solution.write_text(SOLUTION)
    monkeypatch.setattr(proving, "_SEEDS_OF_ANSWERS", 1)
    return made

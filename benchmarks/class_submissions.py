"""The classes that are graded: right, wrong, crashing and looping programs, each made different by a comment."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import cycle
from pathlib import Path

from course_kit.authoring.corpus import load_corpus

ROOT = Path(__file__).resolve().parent.parent
EXERCISE = "temperature_service"
LOOP = "limit.time"
LOOP_EVERY = 50
_CRASHING = ("start.crash", "start.exit", "start.import", "start.syntax")
# What contestants without isolation can run, too.
_HARMLESS = (
    "math.formula",
    "math.integer_division",
    "validation.missing",
    "validation.no_reason",
    "validation.overzealous",
    "name.service",
    "field.type",
    "service.no_return",  # never answers
)


@dataclass(frozen=True)
class Submission:
    """A student's program; `kind` is "right" or the name of its mistake."""

    student: str
    kind: str
    text: str
    exercise: str = EXERCISE

    @property
    def cell(self) -> str:
        """Its text for a notebook's cell, where the last lines would run the node for ever."""
        return self.text.split('\nif __name__ == "__main__"', maxsplit=1)[0] + f"\n# handed in by {self.student}"


def right(number: int, exercise: str = EXERCISE) -> list[Submission]:
    """So many correct ones."""
    return _named(["right"] * number, exercise)


def mixed() -> list[Submission]:
    """Twenty for all contestants: 8 right, 8 wrong (one of them silent), 3 crashing, 1 looping; as they come."""
    kinds = ["right"] * 8 + [*_HARMLESS, *_CRASHING[:1], *_CRASHING[2:], LOOP]
    return _named([kinds[number * 7 % len(kinds)] for number in range(len(kinds))])  # 7 and 20 share no factor


def large(number: int) -> list[Submission]:
    """A class for ours alone: 2 of 5 right, 1 of 10 crashing, the others any mistake there is; one in 50 loops."""
    wrong = cycle(name for name in sorted(_programs(EXERCISE)) if name not in (LOOP, "right", *_CRASHING))
    crashing = cycle(_CRASHING)
    kinds = []
    for place in range(number):
        ordinary = "right" if place % 5 in (0, 2) else next(crashing) if place % 10 == 1 else next(wrong)
        kinds.append(LOOP if place % LOOP_EVERY == LOOP_EVERY - 1 else ordinary)
    return _named(kinds)


def _named(kinds: list[str], exercise: str = EXERCISE) -> list[Submission]:
    students = [f"s{place:04}" for place in range(len(kinds))]
    return [
        Submission(student, kind, f"{_programs(exercise)[kind]}\n# handed in by {student}\n", exercise)
        for student, kind in zip(students, kinds, strict=True)
    ]


@lru_cache(maxsize=4)
def _programs(exercise: str) -> dict[str, str]:
    found = load_corpus(exercise, ROOT)
    wrong = (*found.of_kind("broken"), *found.of_kind("slip"))
    programs = {"right": found.of_kind("solution")[0], **{one.name: one for one in wrong}}
    return {name: "".join(one.texts().values()) for name, one in programs.items()}  # each has one file

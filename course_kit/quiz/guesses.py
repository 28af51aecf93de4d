"""What the lessons ask: guesses before a cell is run, and the questions at a lesson's end. Read from `data/guesses/`.

One file a notebook, called like it. Each wrong choice has an explanation of its own, which names the misconception.
"""

from __future__ import annotations

import hashlib
import sys
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.quiz.bank import BankError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Mapping

FOLDER = Path(__file__).parent / "data" / "guesses"
GUESS, CHECK = "guess", "check"


@dataclass(frozen=True)
class QuestionChoice:
    """One of the answers that can be chosen."""

    text: str
    why: str
    is_right: bool


@dataclass(frozen=True)
class LessonQuestion:
    """One question of a lesson."""

    name: str
    text: str
    choices: tuple[QuestionChoice, ...]
    kind: str

    @property
    def right(self) -> int:
        """The place of the right choice."""
        return next(place for place, choice in enumerate(self.choices) if choice.is_right)


def lessons() -> list[str]:
    """The names of the lessons with questions, in their order, demos last: "00_welcome", ..., "demos/01_deadlock"."""
    found = [path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.toml")]
    return sorted(found, key=lambda name: ("/" in name, name))


@cache
def of_lesson(lesson: str) -> Mapping[str, LessonQuestion]:
    """The questions of a lesson by their whole names, in the file's order."""
    if lesson not in lessons():
        raise BankError(f"There are no questions for '{lesson}'. There are some for {', '.join(lessons())}.")
    return parse(lesson, (FOLDER / f"{lesson}.toml").read_text(encoding="utf-8"))


def question(name: str) -> LessonQuestion:
    """The question of a name such as "01_services/late_display"."""
    lesson, _, _ = name.rpartition("/")
    found = of_lesson(lesson)
    if name not in found:
        raise BankError(f"There is no question '{name}'. There are {', '.join(found)}.")
    return found[name]


def checks(lesson: str) -> list[LessonQuestion]:
    """The questions at a lesson's end."""
    return [one for one in of_lesson(lesson).values() if one.kind == CHECK]


def parse(lesson: str, text: str) -> Mapping[str, LessonQuestion]:
    """The questions in a TOML text."""
    try:
        content = tomllib.loads(text)
        found = [_question(lesson, kind, entry) for kind in (GUESS, CHECK) for entry in content.get(kind, ())]
    except (tomllib.TOMLDecodeError, KeyError, TypeError, ValueError) as problem:
        raise BankError(f"The questions of {lesson} have a mistake: {problem}") from problem
    names = [one.name for one in found]
    if len(set(names)) < len(names) or not found:
        raise BankError(f"The questions of {lesson} have an id twice, or there are none.")
    return {one.name: one for one in found}


def _question(lesson: str, kind: str, entry: Mapping[str, Any]) -> LessonQuestion:
    name = f"{lesson}/{entry['id']}"
    pairs = [(*entry["right"], True), *((*wrong, False) for wrong in entry["wrong"])]
    choices = [QuestionChoice(text, why, is_right) for text, why, is_right in pairs]
    if len({choice.text for choice in choices}) < len(choices) or len(choices) < 2:  # noqa: PLR2004 - or it is none
        raise ValueError(f"{name} needs two or more different choices")
    # Authors write the right one first. Any order will do that is the same on every machine and tells nothing.
    choices.sort(key=lambda choice: hashlib.sha256(f"{name}/{choice.text}".encode()).digest())
    return LessonQuestion(name, entry["question"], tuple(choices), kind)

"""What the lessons ask: guesses before a cell is run, and the questions at a lesson's end. Read from `data/guesses/`.

What a learner has guessed is kept beside their progress, one small file a question: the first try counts, the last is
shown.
"""

from __future__ import annotations

import hashlib
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Mapping

FOLDER = Path(__file__).parent / "data" / "guesses"
GUESS, CHECK = "guess", "check"


class NoSuchQuestionError(ValueError):
    """No lesson asks that; the text names what there is."""


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
    def right_place(self) -> int:
        """The place of the right choice."""
        return next(place for place, choice in enumerate(self.choices) if choice.is_right)


def lesson_names() -> list[str]:
    """The names of the lessons with questions, in their order, demos last: "00_welcome", ..., "demos/01_deadlock"."""
    found = [path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.rglob("*.toml")]
    return sorted(found, key=lambda name: ("/" in name, name))


@cache
def of_lesson(lesson: str) -> Mapping[str, LessonQuestion]:
    """The questions of a lesson by their whole names, in the file's order."""
    if lesson not in (names := lesson_names()):
        raise NoSuchQuestionError(f"There are no questions for '{lesson}'. There are some for {', '.join(names)}.")
    content = msgspec.toml.decode((FOLDER / f"{lesson}.toml").read_text(encoding="utf-8"))
    found = [_question(lesson, kind, entry) for kind in (GUESS, CHECK) for entry in content.get(kind, ())]
    return {question.name: question for question in found}


def find_question(name: str) -> LessonQuestion:
    """The question of a name such as "01_services/late_display"."""
    lesson, _, _ = name.rpartition("/")
    found = of_lesson(lesson)
    if name not in found:
        raise NoSuchQuestionError(f"There is no question '{name}'. There are {', '.join(found)}.")
    return found[name]


def check_questions(lesson: str) -> list[LessonQuestion]:
    """The questions at a lesson's end."""
    return [question for question in of_lesson(lesson).values() if question.kind == CHECK]


def _question(lesson: str, kind: str, entry: Mapping[str, Any]) -> LessonQuestion:
    name = f"{lesson}/{entry['id']}"
    pairs = [(*entry["right"], True), *((*wrong, False) for wrong in entry["wrong"])]
    choices = [QuestionChoice(text, why, is_right) for text, why, is_right in pairs]
    # Authors write the right one first. Any order will do that is the same on every machine and tells nothing.
    choices.sort(key=lambda choice: hashlib.sha256(f"{name}/{choice.text}".encode()).digest())
    return LessonQuestion(name, entry["question"], tuple(choices), kind)


class Guess(msgspec.Struct, frozen=True):
    """What was chosen for a question."""

    first: str
    first_right: bool
    last: str


@dataclass(frozen=True)
class Score:
    """How a lesson's questions of one kind went."""

    lesson: str
    kind: str
    right: int
    answered: int
    count: int


class GuessRecord:
    """The answers of this learner. Where nothing can be kept, as in tests, they are known as long as this object."""

    def __init__(self) -> None:
        self._folder = environment.paths.guess_folder()
        self._known: dict[str, Guess] = {}

    def find_guess(self, question: LessonQuestion) -> Guess | None:
        """What was chosen for a question; None before that."""
        if question.name not in self._known and self._folder is not None:
            with suppress(OSError, ValueError, RecursionError):  # it is missing, or has something else in it
                kept = (self._folder / f"{question.name}.json").read_bytes()
                self._known[question.name] = msgspec.json.decode(kept, type=Guess)
        return self._known.get(question.name)

    def choose(self, question: LessonQuestion, place: int) -> Guess:
        """Keep a choice; the first one stays what it was."""
        chosen = question.choices[place]
        before = self.find_guess(question) or Guess(chosen.text, chosen.is_right, "")
        now = msgspec.structs.replace(before, last=chosen.text)
        self._known[question.name] = now
        if self._folder is not None:
            with suppress(OSError):  # the panel works and only forgets
                environment.write_atomically(self._folder / f"{question.name}.json", msgspec.json.encode(now))
        return now


def lesson_scores() -> list[Score]:
    """How each lesson went of which any question was answered, in the lessons' order."""
    record, found = GuessRecord(), []
    for lesson in lesson_names():
        for kind in (GUESS, CHECK):
            asked = [question for question in of_lesson(lesson).values() if question.kind == kind]
            answers = [answer for question in asked if (answer := record.find_guess(question)) is not None]
            if answers:
                right = sum(answer.first_right for answer in answers)
                found.append(Score(lesson, kind, right, len(answers), len(asked)))
    return found


def chosen_answers() -> dict[str, str]:
    """What was chosen last, by the question's text; both without the marks around code."""
    record = GuessRecord()
    asked = [question for lesson in lesson_names() for question in of_lesson(lesson).values()]
    found = {question.text: record.find_guess(question) for question in asked}
    return {text.replace("`", ""): guess.last.replace("`", "") for text, guess in found.items() if guess is not None}

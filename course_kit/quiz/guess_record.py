"""What a learner has guessed, kept beside their progress: the first try of each question counts, the last is shown.

One small file a question, so that two notebooks never write the same one.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.quiz import guesses

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.quiz.guesses import LessonQuestion


@dataclass(frozen=True)
class Guessed:
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
        self._folder = environment.guess_folder()
        self._known: dict[str, Guessed] = {}

    def of(self, question: LessonQuestion) -> Guessed | None:
        """What was chosen for a question; None before that."""
        if question.name not in self._known and (found := _read(self._folder, question.name)) is not None:
            self._known[question.name] = found
        return self._known.get(question.name)

    def choose(self, question: LessonQuestion, place: int) -> Guessed:
        """Keep a choice; the first one stays what it was."""
        chosen = question.choices[place]
        before = self.of(question)
        if before is None:
            now = Guessed(chosen.text, chosen.is_right, chosen.text)
        else:
            now = Guessed(before.first, before.first_right, chosen.text)
        self._known[question.name] = now
        if self._folder is not None:
            with suppress(OSError):  # the panel works and only forgets
                environment.write_atomically(self._folder / f"{question.name}.json", json.dumps(asdict(now)))
        return now


def scores() -> list[Score]:
    """How each lesson went of which any question was answered, in the lessons' order."""
    record, found = GuessRecord(), []
    for lesson in guesses.lessons():
        for kind in (guesses.GUESS, guesses.CHECK):
            asked = [one for one in guesses.of_lesson(lesson).values() if one.kind == kind]
            answers = [answer for one in asked if (answer := record.of(one)) is not None]
            if answers:
                right = sum(answer.first_right for answer in answers)
                found.append(Score(lesson, kind, right, len(answers), len(asked)))
    return found


def chosen() -> dict[str, str]:
    """What was chosen last, by the question's text; both without the marks around code."""
    record = GuessRecord()
    asked = [one for lesson in guesses.lessons() for one in guesses.of_lesson(lesson).values()]
    found = {one.text: record.of(one) for one in asked}
    return {text.replace("`", ""): guess.last.replace("`", "") for text, guess in found.items() if guess is not None}


def _read(folder: Path | None, name: str) -> Guessed | None:
    """What a file says; None where there is none, or something else in it."""
    try:
        entry = json.loads((folder / f"{name}.json").read_bytes()) if folder is not None else None
        found = Guessed(**entry) if isinstance(entry, dict) else None
    except (OSError, ValueError, TypeError, RecursionError):
        return None
    if found is None or not (isinstance(found.first, str) and isinstance(found.last, str)):
        return None
    return found if isinstance(found.first_right, bool) else None

"""A question of a lesson, to be answered with a click. A guess is explained when its cell has run."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

from course_kit.panels.base import WordedWidget, draw, of_files
from course_kit.quiz import guesses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.quiz.guesses import LessonQuestion

_LETTERS = "ABCDEFGH"
_TITLES = {guesses.GUESS: "Guess before you run the next cell", guesses.CHECK: "Check yourself"}
_LOOK = "Run the next cell and look."
_HOW = "(To be answered with a click in a live notebook.)"


class GuessForm(anywidget.AnyWidget):
    """What the browser shows. The questions carry no answer: what is right stays in the kernel until one has chosen."""

    _esm = of_files("dom.js", "guess_panel.js")
    _css = of_files("frame.css", "guess_panel.css")
    questions = traitlets.List(traitlets.Dict()).tag(sync=True)
    answers = traitlets.Dict().tag(sync=True)
    summary = traitlets.Unicode().tag(sync=True)


class GuessPanel(WordedWidget):
    """One question, or several below each other. It needs no node, and stays when the lab ends."""

    widget: GuessForm

    def __init__(self, questions: Sequence[LessonQuestion]) -> None:
        self._questions = {question.name: question for question in questions}
        # With several subshells, two events of the browser may be handled at once.
        self._one_at_a_time = threading.RLock()
        self._record = guesses.GuessRecord()
        module = sys.modules.get("IPython") if questions[0].kind == guesses.GUESS else None
        self._shell: Any = module.get_ipython() if module else None
        self._cells_to_end = 2 if self._shell else 0  # its own, and the one it asks about
        if self._shell:
            self._shell.events.register("post_run_cell", self._count_cell)
        self.widget = GuessForm(questions=[_show_question(question) for question in questions])
        self.widget.on_msg(self._handle_message)
        self._show()

    def describe(self) -> str:
        """The questions and their choices; nothing about what is right, or what was chosen."""
        return "\n\n".join([*map(_in_words, self._questions.values()), _HOW])

    def still(self) -> str:
        """The questions with their choices, and the answers folded away."""
        return str(draw("guess.html", questions=list(self._questions.values()), letters=_LETTERS))

    def answer(self, name: str, place: int) -> None:
        """Choose, as a click in the form does."""
        with self._one_at_a_time:
            self._record.choose(self._questions[name], place)
            self._show()

    def _handle_message(self, _form: object, content: Mapping[str, object], _buffers: object) -> None:
        """The button of a form."""
        name, place = content.get("name"), content.get("place")
        if name in self._questions and isinstance(place, int) and 0 <= place < len(self._questions[str(name)].choices):
            self.answer(str(name), place)

    def _count_cell(self, _result: object) -> None:
        self._cells_to_end -= 1
        if not self._cells_to_end:
            self._shell.events.unregister("post_run_cell", self._count_cell)
            with self._one_at_a_time:
                self._show()

    def _show(self) -> None:
        answers = {name: self._describe_answer(question) for name, question in self._questions.items()}
        self.widget.answers = {name: found for name, found in answers.items() if found}
        done = [found for found in answers.values() if found]
        right = sum(bool(found["first_right"]) for found in done)
        if len(answers) > 1 and done:
            self.widget.summary = f"{right} of {len(answers)} right at the first try, {len(done)} answered."

    def _describe_answer(self, question: LessonQuestion) -> dict[str, object] | None:
        """What the browser shows of an answer; None if it has none, or its choice is gone."""
        known = self._record.find_guess(question)
        texts = [choice.text for choice in question.choices]
        place = texts.index(known.last) if known and known.last in texts else None
        if known is None or place is None:
            return None
        right = question.right_place
        why, why_right = question.choices[place].why, question.choices[right].why
        if self._cells_to_end:
            right, why, why_right = right if place == right else -1, _LOOK, ""
        return {"chosen": place, "first_right": known.first_right, "right": right, "why": why, "why_right": why_right}


def _show_question(question: LessonQuestion) -> dict[str, object]:
    choices = [choice.text for choice in question.choices]
    return {"name": question.name, "title": _TITLES[question.kind], "text": question.text, "choices": choices}


def _in_words(question: LessonQuestion) -> str:
    lines = [f"{letter}. {choice.text}" for letter, choice in zip(_LETTERS, question.choices, strict=False)]
    return "\n".join([question.text, *lines])

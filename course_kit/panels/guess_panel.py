"""A question of a lesson, to be answered with a click. A guess is explained when its cell has run."""

from __future__ import annotations

import sys
import threading
from typing import TYPE_CHECKING

import anywidget
import traitlets

from course_kit.panels.base import WordedWidget, drawn, of_files
from course_kit.quiz import guesses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from course_kit.quiz.guesses import LessonQuestion

_LETTERS = "ABCDEFGH"
_TITLES = {guesses.GUESS: "Guess before you run the next cell", guesses.CHECK: "Check yourself", "demo": "Guess"}
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
        self._questions = {one.name: one for one in questions}
        # With several subshells, two events of the browser may be handled at once.
        self._one_at_a_time = threading.RLock()
        self._record = guesses.GuessRecord()
        self._again: set[str] = set()
        self._cell_has_run = not any(map(_is_about_next_cell, questions)) or not self._await_next_cell()
        self.widget = GuessForm(questions=[_asked(one) for one in questions])
        self.widget.on_msg(self._told)
        self._show()

    def describe(self) -> str:
        """The questions and their choices; nothing about what is right, or what was chosen."""
        return "\n\n".join([*map(_in_words, self._questions.values()), _HOW])

    def still(self) -> str:
        """The questions with their choices, and the answers folded away."""
        return str(drawn("guess.html", questions=list(self._questions.values()), letters=_LETTERS))

    def answer(self, name: str, place: int) -> None:
        """Choose, as a click in the form does."""
        with self._one_at_a_time:
            self._record.choose(self._questions[name], place)
            self._again.discard(name)
            self._show()

    def again(self, name: str) -> None:
        """Hide the answer, to try once more. What was chosen first still counts."""
        with self._one_at_a_time:
            self._again.add(name)
            self._show()

    def _told(self, _form: object, content: Mapping[str, object], _buffers: object) -> None:
        """A button of the form."""
        name, place = content.get("name"), content.get("place")
        if name not in self._questions:
            return
        if content.get("do") == "again":
            self.again(str(name))
        elif isinstance(place, int) and 0 <= place < len(self._questions[str(name)].choices):
            self.answer(str(name), place)

    def _await_next_cell(self) -> bool:
        """Explain when the cell below has run; False where no cells are run."""
        shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
        if shell is None:
            return False

        def end_own_cell(_result: object) -> None:
            shell.events.unregister("post_run_cell", end_own_cell)
            shell.events.register("post_run_cell", explain)

        def explain(_result: object) -> None:
            shell.events.unregister("post_run_cell", explain)
            with self._one_at_a_time:
                self._cell_has_run = True
                self._show()

        shell.events.register("post_run_cell", end_own_cell)
        return True

    def _show(self) -> None:
        answers = {name: self._describe_answer(one) for name, one in self._questions.items()}
        self.widget.answers = {name: found for name, found in answers.items() if found and name not in self._again}
        done = [found for found in answers.values() if found]
        right = sum(bool(found["first_right"]) for found in done)
        if len(answers) > 1 and done:
            self.widget.summary = f"{right} of {len(answers)} right at the first try, {len(done)} answered."

    def _describe_answer(self, question: LessonQuestion) -> dict[str, object] | None:
        """What the browser shows of an answer; None where there is none, or its choice is no longer there."""
        known = self._record.of(question)
        place = next((place for place, one in enumerate(question.choices) if known and one.text == known.last), None)
        if known is None or place is None:
            return None
        shown: dict[str, object] = {"chosen": place, "first_right": known.first_right}
        if not self._cell_has_run:
            return {**shown, "right": place if place == question.right else None, "why": _LOOK, "why_right": ""}
        whys = {"why": question.choices[place].why, "why_right": question.choices[question.right].why}
        return {**shown, "right": question.right, **whys}


def _is_about_next_cell(question: LessonQuestion) -> bool:
    return question.kind == guesses.GUESS and not question.name.startswith("demos/")


def _asked(question: LessonQuestion) -> dict[str, object]:
    title = _TITLES["demo" if question.name.startswith("demos/") else question.kind]
    choices = [choice.text for choice in question.choices]
    return {"name": question.name, "title": title, "text": question.text, "choices": choices}


def _in_words(question: LessonQuestion) -> str:
    lines = [f"{letter}. {choice.text}" for letter, choice in zip(_LETTERS, question.choices, strict=False)]
    return "\n".join([question.text, *lines])

"""Exercise 4's quiz as a panel: choose, have it marked as the grader marks it, write the file to hand in."""

from __future__ import annotations

import ast
import json
import shlex
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import anywidget
import traitlets

from course_kit import environment, quiz
from course_kit.panels.base import Panel, draw, of_files, still
from course_kit.text.console import in_points

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.quiz import Half, Marks, Questions

Answers = dict[str, tuple[str, str]]


def keep_usable(questions: Questions, choices: object) -> Answers:
    """Of whatever a browser or a file holds, the pairs of words that can be chosen; the rest is left out."""
    found: Answers = {}
    for scenario in questions.scenarios:
        pair = choices.get(scenario.id) if isinstance(choices, dict) else None
        if not isinstance(pair, (list, tuple)) or len(pair) != 2:  # noqa: PLR2004 - a pair
            continue
        pattern = pair[0] if pair[0] in quiz.PATTERNS else ""
        reason = pair[1] if pair[1] in tuple(scenario.reasons) else ""
        if pattern or reason:
            found[scenario.id] = (pattern, reason)
    return found


def _load_kept(path: Path) -> object:
    """The choices kept beside the course; None when there are none, or they cannot be read."""
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def write(questions: Questions, answers: Mapping[str, tuple[str, str]], name: str) -> str:
    """Write the answers as a Python file and say in a sentence what became of it."""
    if not name.strip():
        return "Nothing was written: give the file a name, such as my_answers.py."
    path = Path(name.strip()).expanduser()
    path = path if path.suffix == ".py" else path.with_name(f"{path.name}.py")
    try:
        if path.exists() and not _is_ours(questions, path):
            return f"Nothing was written: {path.name} already exists with other content. Choose another name."
        environment.write_atomically(path, questions.sheet(answers), folders=False)
    except (OSError, ValueError) as problem:
        return f"Nothing was written: {getattr(problem, 'strerror', None) or problem}. Choose another name."
    share = f"{sum(all(pair) for pair in answers.values())} of {len(questions.scenarios)} answers"
    return f"{path.name} is written, with {share}. {_how_to_grade(path, questions)}"


def _is_ours(questions: Questions, path: Path) -> bool:
    """Whether a file is, letter by letter, what the panel writes for the answers in it."""
    text = path.read_text(encoding="utf-8")
    try:
        found = ast.literal_eval(text.partition("\nanswers = ")[2])
    except (ValueError, SyntaxError):
        return False
    return text == questions.sheet(keep_usable(questions, found))


def _how_to_grade(path: Path, questions: Questions) -> str:
    seed = "" if questions.seed == quiz.DEFAULT_SEED else f" --seed {questions.seed}"
    command, path = "course-kit", path.resolve()
    for folder in filter(None, (environment.learner_folder(), environment.checkout_folder())):  # each has `./course`
        if path.is_relative_to(folder):
            command, path = "./course", path.relative_to(folder)
            break
    return f"To grade it, in a terminal: {command} grade pattern_choice {shlex.quote(str(path))}{seed}"


FILE_NAME = "my_answers.py"
_SIGNS = ("✗", "½", "✓")  # by how many of pattern and reason are right
_DESCRIPTION = (
    "Quiz: which communication pattern fits? {count} scenarios (seed {seed}), to be answered here in a live notebook. "
    "As text: quiz.show({argument})."
)


class QuizForm(anywidget.AnyWidget):
    """What the browser shows. The questions carry no answer: what is right stays in the kernel."""

    _esm = of_files("quiz_panel.js")
    _css = of_files("quiz_panel.css")
    patterns = traitlets.List(traitlets.Unicode()).tag(sync=True)
    questions = traitlets.List(traitlets.Dict()).tag(sync=True)
    choices = traitlets.Dict().tag(sync=True)
    marks = traitlets.Dict().tag(sync=True)
    summary = traitlets.Unicode().tag(sync=True)
    file_name = traitlets.Unicode(FILE_NAME).tag(sync=True)
    said = traitlets.Unicode().tag(sync=True)


class QuizPanel(Panel):
    """The ten scenarios of a seed, one at a time."""

    widget: QuizForm

    def __init__(self, seed: int = quiz.DEFAULT_SEED) -> None:
        self._questions = quiz.show(seed)
        super().__init__(seed)
        # With several subshells, two events of the browser may be handled at once.
        self._one_at_a_time = threading.RLock()
        self._kept = environment.paths.own_run_dir() / "quiz" / f"seed_{seed}.json"
        self.widget = QuizForm(
            patterns=list(quiz.PATTERNS),
            questions=[_question(scenario, seed) for scenario in self._questions.scenarios],
            choices=keep_usable(self._questions, _load_kept(self._kept)),
        )
        self.widget.observe(self._keep_answers, "choices")
        self.widget.on_msg(self._handle_message)
        self.at_close(self._stop)
        self._show_marks()

    @property
    def answers(self) -> Answers:
        """What has been chosen so far: pattern and reason by the scenario's id, empty where nothing is chosen."""
        return keep_usable(self._questions, self.widget.choices)

    @property
    def result(self) -> quiz.MarkedAnswers:
        """All scenarios as the grader marks them now."""
        scenarios = self._questions.scenarios
        return quiz.mark(scenarios, {scenario.id: ("", "") for scenario in scenarios} | self.answers)

    def describe(self) -> str:
        """What it is; nothing about the choices."""
        seed = self._questions.seed
        argument = "" if seed == quiz.DEFAULT_SEED else f"seed={seed}"
        return _DESCRIPTION.format(count=len(self._questions.scenarios), seed=seed, argument=argument)

    def still(self) -> str:
        """What has been chosen, with its marks; before that the first scenario."""
        first, chosen = self.widget.questions[0], {"answered": self._in_words(), "summary": self.widget.summary}
        picture = draw(
            "still_quiz.html", count=len(self._questions.scenarios), patterns=quiz.PATTERNS, **first, **chosen
        )
        return still(self.describe(), picture, "still_panels.css")

    def answer(self, scenario: str, pattern: str, reason: str) -> None:
        """Choose for one scenario, as a click in the form does."""
        with self._one_at_a_time:
            self.widget.choices = {**self.widget.choices, scenario: [pattern, reason]}

    def write(self, name: str = FILE_NAME) -> str:
        """Write the answers as the file that `grade pattern_choice` takes; says what became of it."""
        with self._one_at_a_time:
            self.widget.said = write(self._questions, self.answers, name)
            return self.widget.said

    def reset(self) -> None:
        """Clear all choices and marks. A file that was written stays."""
        with self._one_at_a_time:
            self.widget.choices = {}
            self.widget.said = "All choices are cleared."

    def _keep_answers(self, _change: object) -> None:
        with self._one_at_a_time:
            with suppress(OSError):  # where nothing can be written, the panel works and only forgets
                environment.write_atomically(self._kept, json.dumps(self.answers), durable=False)
            self._show_marks()
            self.widget.said = ""

    def _handle_message(self, _form: object, content: Mapping[str, object], _buffers: object) -> None:
        """A button of the form."""
        do = content.get("do")
        if do == "reset":
            self.reset()
        elif do == "write":
            self.write(str(content.get("name", "")))

    def _in_words(self) -> list[dict[str, object]]:
        """What is chosen, by scenario, with the sign of its marks."""
        found: list[dict[str, object]] = []
        for number, scenario in enumerate(self._questions.scenarios, start=1):
            pattern, reason = self.answers.get(scenario.id, ("", ""))
            marks = self.widget.marks.get(scenario.id)
            sign = _SIGNS[marks["pattern"]["right"] + marks["reason"]["right"]] if marks else ""
            if pattern or reason:
                words = {"pattern": pattern, "reason": scenario.reasons.get(reason, ""), "sign": sign}
                found.append({"number": number, "title": scenario.title, **words})
        return found

    def _show_marks(self) -> None:
        """Mark each scenario that is answered in full; half an answer is not marked yet."""
        result, complete = self.result, {name for name, pair in self.answers.items() if all(pair)}
        marked = [marks for marks in result.marks if marks.scenario.id in complete and marks.scenario.has_answer]
        self.widget.marks = {
            marks.scenario.id: {"pattern": _facts(marks.pattern), "reason": _facts(marks.reason)} for marks in marked
        }
        self.widget.summary = _summary(len(complete), result, marked)

    def _stop(self) -> None:
        self.widget.unobserve_all()
        self.widget.on_msg(self._handle_message, remove=True)


def _question(scenario: quiz.Scenario, seed: int) -> dict[str, object]:
    reasons = [list(reason) for reason in quiz.reasons_as_shown(scenario, seed)]
    return {"id": scenario.id, "title": scenario.title, "text": scenario.text, "reasons": reasons}


def _facts(half: Half) -> dict[str, object]:
    return {"right": half.right, "explanation": half.explanation}


def _summary(answered: int, result: quiz.MarkedAnswers, marked: list[Marks]) -> str:
    """The line above the form; what is not marked tells nothing about its points."""
    text = f"{answered} of {len(result.marks)} answered."
    needed = f"{quiz.PASS_SHARE * result.max_points:g} of {result.max_points:g}"
    if not result.is_final:
        return f"{text} Your instructor marks these; to pass: {needed} points."
    if not marked:
        return f"{text} To pass: {needed} points."
    if len(marked) < len(result.marks):
        points = sum(marks.points for marks in marked)
        return f"{text} {points:g} of {in_points(len(marked))} so far; to pass: {needed}."
    verdict = "passed" if result.passed else f"not passed yet (to pass: {needed})"
    return f"{text} {result.points:g} of {in_points(result.max_points)}, {verdict}."

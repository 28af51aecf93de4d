"""Where answers of the quiz go: kept between runs of a cell, and written as the file that is handed in."""

from __future__ import annotations

import ast
import json
import shlex
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment, quiz

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.quiz import Questions

Answers = dict[str, tuple[str, str]]


def usable(questions: Questions, choices: object) -> Answers:
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


class Kept:
    """Choices kept beside the course, so that running the cell again or a new kernel does not lose them."""

    def __init__(self, seed: int) -> None:
        self._path = environment.paths.own_run_dir() / "quiz" / f"seed_{seed}.json"

    def load(self) -> object:
        """What was kept; None when nothing was, or it cannot be read."""
        try:
            return json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return None

    def save(self, answers: Mapping[str, tuple[str, str]]) -> None:
        """Keep these instead. Where nothing can be written, the panel works and only forgets."""
        with suppress(OSError):
            environment.write_atomically(self._path, json.dumps(answers), durable=False)


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
    return text == questions.sheet(usable(questions, found))


def _how_to_grade(path: Path, questions: Questions) -> str:
    seed = "" if questions.seed == quiz.DEFAULT_SEED else f" --seed {questions.seed}"
    command, path = "course-kit", path.resolve()
    for folder in filter(None, (environment.learner_folder(), environment.checkout())):  # each has `./course`
        if path.is_relative_to(folder):
            command, path = "./course", path.relative_to(folder)
            break
    return f"To grade it, in a terminal: {command} grade pattern_choice {shlex.quote(str(path))}{seed}"

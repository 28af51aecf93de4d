"""Programs in an edition that could be a submission: which exercise each could be for, and as what it is graded."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.authoring.fragments import Skeleton
from course_kit.authoring.passages import passages
from course_kit.authoring.programs import parsed, programs

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.grading.exercise import Exercise

_NAME = re.compile(r"[a-z~/][a-z0-9_/]{3,}\Z")  # of a node, a service, a topic, a parameter or a scenario
_FEWEST_KEYS = 3  # of a dictionary that answers an exercise


@dataclass(frozen=True)
class EditionProgram:
    """A program to grade.

    Attributes:
        exercise: the id of the exercise it could be for.
        source: the program.
        file: where it was found, relative to the edition.
        place: where in that file.
    """

    exercise: str
    source: str
    file: str
    place: str

    @property
    def program(self) -> tuple[str, str]:
        """What is graded: the same for all places in which it stands."""
        return self.exercise, self.source.strip()


class ExerciseClues:
    """What a program for one exercise can be told by."""

    def __init__(self, task: Exercise, starter: str, solution: str = "") -> None:
        """Look at what an exercise's own programs name.

        Args:
            task: the exercise.
            starter: its starter.
            solution: its solution, empty if there is none.
        """
        self.task = task
        self._skeleton = Skeleton(starter, solution)
        self._class = re.compile(rf"\b{task.class_name}\b" if task.class_name else r"(?!)")
        trees = [tree for model in (starter, solution) if (tree := parsed(model)) is not None]
        self.names = frozenset(name for tree in trees for name in (_keys(tree) if task.variable else _names(tree)))

    def may_stand_in(self, text: str) -> bool:
        """Whether a text could hold a program for it: cheap, and rather yes than no."""
        named = self._class.search(text) is not None or any(name in text for name in self.names)
        return named or self._skeleton.may_take(text)

    def submissions(self, text: str, tree: ast.Module) -> Iterator[str]:
        """What to hand in of a program, as it stands or completed; nothing if it is not for this exercise."""
        if self.task.variable:
            yield from self._answers(text, tree)
            return
        imports = _imports(tree)
        classes = {node.name for node in ast.walk(tree) if isinstance(node, ast.ClassDef)}
        if self.task.class_name in classes or ("rclpy" in imports and not self.names.isdisjoint(_names(tree))):
            yield text if imports else f"{self._skeleton.imports}\n\n{text}"
        if completed := self._skeleton.completed(text, tree):
            yield completed

    def _answers(self, text: str, tree: ast.Module) -> Iterator[str]:
        variable = self.task.variable
        if re.search(rf"^{variable}\b", text, re.MULTILINE):
            yield text
        for node in ast.walk(tree):
            if isinstance(node, ast.Dict):
                keys = {key.value for key in node.keys if isinstance(key, ast.Constant)}
                if len(keys & self.names) >= _FEWEST_KEYS:
                    yield f"{variable} = {ast.unparse(node)}\n"


def find(edition: Path, wanted: Sequence[ExerciseClues]) -> list[EditionProgram]:
    """The programs in an edition that could be submissions; one that stands in several files comes for each of them.

    Args:
        edition: its folder.
        wanted: what to look for.
    """
    found: dict[tuple[tuple[str, str], str], EditionProgram] = {}
    for path in sorted(path for path in edition.rglob("*") if path.is_file()):
        for one in _find_in(path, path.relative_to(edition).as_posix(), wanted):
            found.setdefault((one.program, one.file), one)
    return list(found.values())


def _find_in(path: Path, file: str, wanted: Sequence[ExerciseClues]) -> Iterator[EditionProgram]:
    for passage in passages(path):
        for program, tree in programs(passage, lambda text: any(one.may_stand_in(text) for one in wanted)):
            for one in wanted:
                for source in one.submissions(program.text, tree):
                    yield EditionProgram(one.task.id, source, file, program.place)


def _imports(tree: ast.AST) -> set[str]:
    """The packages that a program imports."""
    modules = {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    return {module.partition(".")[0] for module in modules}


def _names(tree: ast.AST) -> set[str]:
    """The names that a program of nodes gives to what it offers and uses."""
    texts = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)}
    return {text.strip("/~") for text in texts if _NAME.match(text) and "__" not in text}


def _keys(tree: ast.AST) -> set[str]:
    """The keys of a program's dictionaries."""
    keys = {key for node in ast.walk(tree) if isinstance(node, ast.Dict) for key in node.keys}
    return {key.value for key in keys if isinstance(key, ast.Constant) and isinstance(key.value, str)}

"""The submissions that prove an exercise's grader: right ones in many styles, and wrong ones that must be told apart.

They lie in the checkout: `exercises/` and `solutions/`, right programs in `tests/grading/correct/`, one wrong program
for each diagnosis in `tests/broken/`, and in `tests/slips/` right programs with one thing changed.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from course_kit.grading import GradingError, exercise

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.exercise import Exercise


@dataclass(frozen=True)
class ProofSubmission:
    """One program, and what it is there for.

    Attributes:
        exercise: the exercise's id.
        kind: starter, solution, variant (right in another style), broken (named after its diagnosis) or slip.
        name: the file's name without its ending, or the slip's.
        path: the file; of a slip the right program it is made from.
        changes: what a slip replaces by what.
        failed: the checks a slip fails, each with its diagnosis, None where none is established.
        says: a fact that the messages of a slip's failed checks name.
        breaks: the ids of the sentences of the task that it does not keep.
        seed: what the checks draw from for it; as everywhere in this run when None.
    """

    exercise: str
    kind: str
    name: str
    path: Path
    changes: tuple[tuple[str, str], ...] = ()
    failed: frozenset[tuple[str, str | None]] = frozenset()
    says: str = ""
    breaks: tuple[str, ...] = ()
    seed: int | None = None

    def text(self) -> str:
        """The program to grade.

        Raises:
            GradingError: a slip changes something that does not stand in its program exactly once.
        """
        text = self.path.read_text(encoding="utf-8")
        for old, new in self.changes:
            if text.count(old) != 1:
                raise GradingError(
                    f"The slip {self.name} of {self.exercise} replaces a text that occurs {text.count(old)} times in "
                    f"{self.path.name}, not once: {old.strip()!r}."
                )
            text = text.replace(old, new)
        return text


@dataclass(frozen=True)
class Corpus:
    """All submissions of one exercise."""

    task: Exercise
    submissions: tuple[ProofSubmission, ...]

    def of(self, kind: str) -> tuple[ProofSubmission, ...]:
        """Those of one kind."""
        return tuple(one for one in self.submissions if one.kind == kind)


def all_exercises(root: Path) -> list[str]:
    """The ids of the course's exercises, in the course's order."""
    folder = root / "exercises"
    ids = [path.parent.name for path in folder.glob("*/exercise.toml")]
    return sorted(ids, key=lambda name: (exercise.load(name, folder).order, name))


def load(exercise_id: str, root: Path) -> Corpus:
    """The sets of one exercise of the checkout `root`.

    Raises:
        GradingError: there is no such exercise, or a file of its sets has a mistake.
    """
    task = exercise.load(exercise_id, root / "exercises")
    tests = root / "tests"
    found = [ProofSubmission(task.id, "starter", name, task.folder / name) for name in (task.starter, task.notebook)]
    solution = root / "solutions" / task.id / f"{task.id}.py"
    if solution.is_file():
        found.append(ProofSubmission(task.id, "solution", solution.name, solution))
    slips, breaks = _slips(task.id, tests, solution)
    for kind, folder in (("variant", tests / "grading" / "correct"), ("broken", tests / "broken")):
        paths = sorted((folder / task.id).glob("*.py"))
        found += [
            ProofSubmission(
                task.id, kind, path.stem, path, breaks=breaks.pop(path.stem, ()) if kind == "broken" else ()
            )
            for path in paths
        ]
    if breaks:
        raise GradingError(
            f"tests/broken/{task.id} has no {next(iter(breaks))}.py, though [broken] says what it breaks."
        )
    found += slips
    for one in found:
        if one.changes:
            one.text()
    return Corpus(task, tuple(found))


def _slips(exercise_id: str, tests: Path, solution: Path) -> tuple[list[ProofSubmission], dict[str, tuple[str, ...]]]:
    """The slips, and by the names of broken programs the sentences that those do not keep: the table `broken`."""
    path = tests / "slips" / f"{exercise_id}.toml"
    if not path.is_file():
        return [], {}
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
        breaks = {name: tuple(ids) for name, ids in table.pop("broken", {}).items()}
        return [_slip(exercise_id, name, entry, tests, solution) for name, entry in table.items()], breaks
    except (ValueError, KeyError, TypeError) as problem:
        what = f"'{problem.args[0]}' is missing" if isinstance(problem, KeyError) else problem
        raise GradingError(f"{path} cannot be used: {what}.") from problem


def _slip(exercise_id: str, name: str, entry: dict[str, Any], tests: Path, solution: Path) -> ProofSubmission:
    base = tests / "grading" / "correct" / exercise_id / f"{entry['base']}.py" if "base" in entry else solution
    return ProofSubmission(
        exercise_id,
        "slip",
        name,
        base,
        changes=tuple((change["old"], change["new"]) for change in entry["changes"]),
        failed=frozenset((check, code or None) for check, code in entry["failed"].items()),
        says=entry.get("says", ""),
        breaks=tuple(entry.get("breaks", ())),
        seed=entry.get("seed"),
    )

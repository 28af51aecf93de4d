"""The submissions that prove an exercise's grader: right ones in many styles, and wrong ones that it must tell apart.

CONTRIBUTING says where they lie. An exercise of another folder has them in `proof/`. Where a submission has several
files, a right program is a folder with those that differ from the solution.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import msgspec

from course_kit.grading import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.grading.model.exercise import Exercise, load_exercise, read_exercise
from course_kit.grading.model.plain_data import convert_record

if TYPE_CHECKING:
    from pathlib import Path


@dataclass(frozen=True)
class ProofSubmission:
    """One program, and what it is there for."""

    exercise: str  # the exercise's id
    kind: str  # starter, solution, variant (right in another style), broken (named after its diagnosis) or slip
    name: str  # the file's name without its ending, or the slip's
    path: Path  # the file or folder; of a slip the right program it is made from
    changes: tuple[tuple[str, str], ...] = ()  # what a slip replaces by what
    files: tuple[Path, ...] = ()  # where a submission has several, all of them
    # the checks a slip fails, each with its diagnosis, None where none is established
    failed: frozenset[tuple[str, str | None]] = frozenset()
    says: str = ""  # a fact that the messages of a slip's failed checks name
    breaks: tuple[str, ...] = ()  # the ids of the sentences of the task that it does not keep
    seed: int | None = None  # what the checks draw from for it; as everywhere in this run when None
    told_in: Path | None = None  # the file that declares a slip

    def texts(self) -> dict[str, str]:
        """The files to grade, by name."""
        texts = {path.name: path.read_text(encoding="utf-8") for path in self.files or (self.path,)}
        for old, new in self.changes:
            if (count := sum(text.count(old) for text in texts.values())) != 1:
                raise GradingError(
                    f"{self.told_in}: the slip {self.name} replaces a text that occurs {count} times in "
                    f"{self.path}, not once: {old.strip()!r}."
                )
            texts = {name: text.replace(old, new) for name, text in texts.items()}
        return texts


@dataclass(frozen=True)
class Corpus:
    """All submissions of one exercise."""

    exercise: Exercise
    submissions: tuple[ProofSubmission, ...]

    def of_kind(self, kind: str) -> tuple[ProofSubmission, ...]:
        """Those of one kind."""
        return tuple(submission for submission in self.submissions if submission.kind == kind)


def all_exercises(root: Path) -> list[str]:
    """The ids of the course's exercises, in the course's order."""
    folder = root / "exercises"
    ids = [path.parent.name for path in folder.glob("*/exercise.toml")]
    return sorted(ids, key=lambda name: (load_exercise(name, folder).order, name))


def folders_of(exercise: Exercise, root: Path) -> tuple[Path, Path, Path]:
    """Where the sets of an exercise lie: right programs, wrong programs, and the file of the slips."""
    if exercise.folder == root / "exercises" / exercise.id:
        tests = root / "tests"
        slips = tests / "slips" / f"{exercise.id}.toml"
        return tests / "grading" / "correct" / exercise.id, tests / "broken" / exercise.id, slips
    proof = exercise.folder / exercise_folders.PROOF
    return proof / "correct", proof / "broken", proof / "slips.toml"


def load_corpus(exercise_id: str, root: Path) -> Corpus:
    """The sets of one exercise of the checkout `root`, or of one that was added."""
    own = root / "exercises" / exercise_id
    exercise = read_exercise(own) if own.is_dir() else load_exercise(exercise_id)
    notebook, folder = exercise.folder / exercise.notebook, exercise.folder
    begun = tuple(folder / name for name in exercise.files)
    starter = folder if begun else folder / exercise.starter
    found = [
        ProofSubmission(exercise.id, "starter", starter.name, starter, files=begun),
        ProofSubmission(exercise.id, "starter", notebook.name, notebook),
    ]
    correct, broken, table = folders_of(exercise, root)
    right = [("solution", exercise.solution.name, exercise.solution)] if exercise.solution.exists() else []
    right += [("variant", path.stem, path) for path in sorted(correct.glob("*" if exercise.files else "*.py"))]
    found += [ProofSubmission(exercise.id, *entry, files=_files(exercise, entry[-1])) for entry in right]
    slips, breaks = _slips(exercise, correct, table)
    for path in sorted(broken.glob("*.py")):
        found.append(ProofSubmission(exercise.id, "broken", path.stem, path, breaks=breaks.pop(path.stem, ())))
    if breaks:
        raise GradingError(f"{broken} has no {next(iter(breaks))}.py, though [broken] says what it breaks.")
    found += slips
    for entry in found:
        if entry.changes:
            entry.texts()
    return Corpus(exercise, tuple(found))


def _files(exercise: Exercise, folder: Path) -> tuple[Path, ...]:
    """All files of a right program, where a submission has several."""
    places = (exercise.solution, folder) if exercise.files else ()
    found = {path.name: path for place in places for path in sorted(place.iterdir())}
    return tuple(path for name, path in found.items() if name.endswith((".py", ".yaml")))


def _slips(exercise: Exercise, correct: Path, file: Path) -> tuple[list[ProofSubmission], dict[str, tuple[str, ...]]]:
    """The slips, and by the names of broken programs the sentences that those do not keep: the table `broken`."""
    if not file.is_file():
        return [], {}
    where = ""
    try:
        table = msgspec.toml.decode(file.read_text(encoding="utf-8"))
        breaks = convert_record(table.pop("broken", {}), dict[str, tuple[str, ...]])
        slips = []
        for name, entry in table.items():
            where = f"in the slip {name}, "
            slips.append(_slip(exercise, name, correct, convert_record(entry, _Slip), file))
    except ValueError as problem:
        raise GradingError(f"{file} cannot be used: {where}{problem}.") from problem
    return slips, breaks


class _Change(msgspec.Struct, forbid_unknown_fields=True):
    old: str
    new: str


class _Slip(msgspec.Struct, forbid_unknown_fields=True):
    """What stands in the file of a slip; for what it is about see `ProofSubmission`."""

    changes: list[_Change]
    failed: dict[str, str]
    base: str = ""  # the right program that it is made from; the solution where none is named
    says: str = ""
    breaks: tuple[str, ...] = ()
    seed: int | None = None


def _slip(exercise: Exercise, name: str, correct: Path, slip: _Slip, file: Path) -> ProofSubmission:
    base = correct / (slip.base if exercise.files else f"{slip.base}.py") if slip.base else exercise.solution
    return ProofSubmission(
        exercise.id,
        "slip",
        name,
        base,
        changes=tuple((change.old, change.new) for change in slip.changes),
        failed=frozenset((check, code or None) for check, code in slip.failed.items()),
        says=slip.says,
        breaks=slip.breaks,
        seed=slip.seed,
        told_in=file,
        files=_files(exercise, base),
    )

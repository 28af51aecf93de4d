"""Chooses each student's submissions, one student after the other; whatever is not chosen is listed with a reason."""

from __future__ import annotations

import re
from collections import Counter
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.classroom.intake import archive, candidates, listing
from course_kit.classroom.intake.candidates import BY_CONTENT, CALLED_ALIKE, NAMED, ONLY_ONE
from course_kit.classroom.intake.listing import Item
from course_kit.classroom.records import Entry
from course_kit.classroom.rules.deadlines import ASSIGNMENT, STAMP, SUBMITTED_AT, read_stamp
from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Exercise, list_exercise_ids, load_exercise
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import FileSummary, copy_file, starter_identities
from course_kit.reader import text
from course_kit.reader.files import YAML
from course_kit.text.sanitize import one_line

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from course_kit.classroom.intake.layouts import HandIn
    from course_kit.classroom.intake.listing import LeftOut
    from course_kit.classroom.intake.sources import OpenedSources
    from course_kit.grading.reading import Reader

_MOST_LISTED = 50  # files of one student that are listed one by one
_MOST_TOLD = 3  # problems of one student in a sentence
_MOST_OTHERS = 10  # of an entry
_NOT_FOUND = "none of it belongs to these exercises"
_NONE_OF_THESE = "it belongs to none of these exercises"
_OF_KIT = "a part of the course kit"
_PACKAGE = "course_kit/__init__.py"
_EXERCISE = re.compile(r"exercises/[^/]+/exercise\.toml")
_FOLDERS = ("course_setup/", "solutions/", "tests/", "benchmarks/", "notebooks/demos/")
_LESSON = re.compile(r"notebooks/\d\d_\w+\.ipynb")
_MOST_COPIES = 10  # of the course in one student's work


class Chooser:
    """Chooses, and keeps what was found."""

    def __init__(self, opened: OpenedSources, exercises: Sequence[Exercise], reader: Reader) -> None:
        self._root = opened.root
        self._reader = reader
        self._listing = opened.listing
        self._may_unpack = opened.is_copy
        self._exercises = exercises
        self.entries: list[Entry] = []
        self.left: LeftOut = []
        self.missing: list[tuple[str, str]] = []
        self.odd: list[tuple[str, str]] = []
        self.dropped: list[tuple[str, str]] = []
        self.others: list[Entry] = []
        self.empty: set[str] = set()

    def take(self, student: str, units: Sequence[HandIn]) -> None:
        """Choose among a student's files."""
        if odd := next((unit.odd for unit in units if unit.odd), ""):
            self.odd.append((student, odd))
        files, problems = self._files(units)
        reasons = {file.path: file.problem for file in files if file.problem}
        choices: list[tuple[Exercise, HandIn, dict[str, str]]] = []
        lost = []
        considered: dict[str, set[str]] = {}  # paths, by exercise
        for exercise in self._exercises:
            found = list(self._candidates(files, exercise))
            considered[exercise.id] = {candidate.path for candidate in found}
            if not found:
                continue
            best, not_chosen = candidates.choose_candidate(found, exercise, files)
            if best.problem:
                lost.append(f"{one_line(best.path)}: {best.problem}")
                why = f"{best.path} would have been used, but cannot be read"
                reasons.update((candidate.path, why) for candidate in found if not candidate.problem)
                continue
            choices.append((exercise, best, not_chosen))
            used = ((path, f"{why}; {best.path} was used instead") for path, why in not_chosen.items())
            reasons.update((path, why) for path, why in used if path not in reasons)
        chosen = {choice.path for _, choice, _ in choices}
        entries = []
        for exercise, choice, not_chosen in choices:
            of_others = [paths for other, paths in considered.items() if other != exercise.id]
            for_it = [file for file in files if file.exercise in ("", exercise.id) and file.folder not in chosen]
            rest = sorted({file.path for file in for_it}.difference(chosen, not_chosen, *of_others))
            reasons_here = {path: why for path, why in not_chosen.items() if path not in chosen}
            entries.append(self._entry(student, exercise, choice, reasons_here, rest))
        taken = {entry.source for entry in entries}
        rest = [file.path for file in files if taken.isdisjoint((file.path, file.folder))]
        not_taken = [(path, reasons.get(path, _NONE_OF_THESE)) for path in rest]
        self._leave(student, not_taken, "they belong to none of these exercises")
        handed_in = {entry.exercise for entry in entries}
        self.missing += [(student, exercise.id) for exercise in self._exercises if exercise.id not in handed_in]
        self.entries += entries
        if not entries:
            self.others.append(_nothing_of(student, units))
        if not (files or problems):
            self.empty.add(student)
        if lost or (not entries and (files or problems)):
            self.dropped.append((student, _join_problems(lost or problems) or _NOT_FOUND))

    def _files(self, units: Sequence[HandIn]) -> tuple[list[HandIn], list[str]]:
        """All files of a student, and what kept some from being found."""
        files: list[HandIn] = []
        problems: list[str] = []
        for unit in units:
            found = listing.look_through(self._listing, unit.item)
            problems += self._note(unit, found.tools, found.unseen)
            files += map(unit.with_item, found.files)
            if not (found.files or found.tools or found.unseen):
                self.left.append((unit.item.path, "an empty folder"))
        files, opened = self._without_zips(self._without_kit(files))
        of_exercise = Counter(file.exercise for file in files)
        wanted = [
            file
            for file in files
            if file.item.is_program or of_exercise[file.exercise] == 1 or file.file_name.endswith((STAMP, YAML))
        ]
        unpacked = self._listing.fetch(file.item for file in wanted if not file.problem)
        files = [file.with_item(replace(file.item, problem=unpacked.get(file.path, file.problem))) for file in files]
        return files + opened, problems

    def _note(self, unit: HandIn, tools: Sequence[tuple[str, str]], unseen: Sequence[tuple[str, str]]) -> list[str]:
        """List what was found beside a student's files; returns what may have been a submission, as sentences."""
        self._leave(unit.student, list(tools), "the same")
        self._leave(unit.student, list(unseen), "the same")
        return [f"{one_line(path)}: {reason}" for path, reason in unseen]

    def _without_kit(self, files: list[HandIn]) -> list[HandIn]:
        """A student's files but for the course's own, where they have handed in a copy of the whole course."""
        own = parts_of_kit(file.path for file in files)
        if own and files:
            self._leave(files[0].student, [(path, _OF_KIT) for path in sorted(own)], "parts of the course kit")
        return [file for file in files if file.path not in own]

    def _without_zips(self, files: list[HandIn]) -> tuple[list[HandIn], list[HandIn]]:
        """A student's files but for zips that could be opened, and what was in these."""
        fitting: list[HandIn] = []
        opened: list[HandIn] = []
        zips = 0
        for file in files:
            if not self._may_unpack or not file.item.is_zip or file.problem:
                fitting.append(file)
                continue
            zips += 1
            contents = listing.StudentFiles((), problem="one zip too many")
            if zips <= archive.MOST_ZIPS:
                contents = self._open(file)
            if contents.problem or not (contents.files or contents.unseen):
                fitting.append(file)
                self._leave(file.student, [(file.path, contents.problem or "an empty zip")], "the same")
                continue
            self._note(file, contents.tools, contents.unseen)
            opened += self._without_kit([file.with_item(item) for item in contents.files])
        return fitting, opened

    def _open(self, file: HandIn) -> listing.StudentFiles:
        if problem := self._listing.fetch([file.item]).get(file.path):
            return listing.StudentFiles((), problem=problem)
        return archive.unpack_students_zip(self._root, file.item)

    def _entry(self, student: str, exercise: Exercise, file: HandIn, reasons: dict[str, str], rest: list[str]) -> Entry:
        platform = _platform_of(file)
        inside = file.path[len(file.inside) + 1 :]
        if file.has_assignments and "/" in inside:  # as nbgrader lays it out, which notes the time just there
            assignment = inside.partition("/")[0]
            platform[ASSIGNMENT] = one_line(assignment)
            if stamp := read_stamp(self._root / file.inside / assignment / STAMP):
                platform[SUBMITTED_AT] = one_line(stamp)
        others = _list_other_files(reasons, rest)
        name = one_line(file.name)
        return Entry(student, exercise.id, file.path, name, file.late, platform, file.why, others, file.worry)

    def _leave(self, student: str, rest: LeftOut, others: str) -> None:
        """List files of a student; of a heap the first ones, and the number of the others with a reason."""
        self.left += rest[:_MOST_LISTED]
        if len(rest) > _MOST_LISTED:
            self.left.append((f"{len(rest) - _MOST_LISTED} more of {student}", others))

    def _candidates(self, files: list[HandIn], exercise: Exercise) -> Iterator[HandIn]:
        for_it = _as_one([file for file in files if file.exercise in ("", exercise.id)], exercise)
        programs = [file for file in for_it if may_be_submission(file.item, exercise)]
        is_named = len(self._exercises) == 1 or bool(for_it and all(file.exercise for file in for_it))
        alone = is_named and (len(programs) == 1 or (not programs and len(for_it) == 1))
        seen = {file.path: self._summarize_file(file, exercise) for file in programs or for_it}
        imported = {name for glance in seen.values() for name in glance.imports}
        starters = starter_identities(exercise)
        for file in programs or for_it:
            glance = seen[file.path]
            sureness = _sureness(file, exercise, glance) or (ONLY_ONE if alone else 0)
            if not sureness:
                continue
            # Whatever it is, its student gets a report that says what is wrong with it.
            is_script = bool(exercise.class_name) and "rclpy" in glance.imports
            fits = glance.found or (is_script and file.file_name.removesuffix(".py") not in imported)
            is_starter = glance.identity in starters
            doubt = self._explain_doubt(file, exercise, glance, fits=fits)
            lacks = [name for name in exercise.files if glance.program and name not in glance.program.files]
            if glance.found and lacks:
                doubt = f"missing: {', '.join(lacks)}"
            yield replace(
                file,
                sureness=sureness,
                changed=_modified_at(self._root / file.path),
                found=glance.found,
                identity=glance.identity,
                imports=glance.imports,
                is_starter=is_starter,
                fits=fits,
                doubt=doubt,
            )

    def _explain_doubt(self, file: HandIn, exercise: Exercise, glance: FileSummary, *, fits: bool) -> str:
        """Why a program will hardly get a point; empty where nothing speaks against it."""
        if file.problem or not file.item.is_program or (glance.found and glance.identity):
            return ""
        path = self._root / file.path
        if glance.identity:
            course = exercise.folder.parent
            for other in (load_exercise(name, course) for name in list_exercise_ids(course) if name != exercise.id):
                if self._summarize_file(file, other).found:
                    return f"it holds {other.asks_for}, which {other.id} asks for"
            together = ", all in one zip or notebook" if exercise.files else ""
            return "" if fits else f"it does not contain {exercise.asks_for}{together}"
        with suppress(OSError):
            if not path.lstat().st_size:
                return "it is empty"
        if text.kind_of_file(file.file_name) == text.NOTEBOOK:
            return f"no cell in it can be read that begins with %%submission {exercise.id}"
        return "no program can be read in it"

    def _summarize_file(self, file: HandIn, exercise: Exercise) -> FileSummary:
        if file.problem or file.item.kind == listing.OTHER or not may_be_submission(file.item, exercise):
            return FileSummary()
        try:
            copy = copy_file(self._root / file.path, whole=False, several=bool(exercise.files))
        except UnreadableError:
            return FileSummary()
        with copy:
            try:
                return self._reader.summarize(copy, exercise)
            except (UnreadableError, GradingError):
                return FileSummary(found=True)  # it may be; whoever reads it next says what is wrong with it


def _as_one(files: Sequence[HandIn], exercise: Exercise) -> list[HandIn]:
    """Files of a submission of several: each folder with some of the wanted ones as one, beside what is in no such."""
    folders = {file.folder: file for file in files if file.file_name in exercise.files and file.inside}
    found = [replace(file, item=Item(folder, listing.FOLDER)) for folder, file in folders.items()]
    return found + [
        file for file in files if file.folder not in folders or text.kind_of_file(file.file_name) == text.NOTEBOOK
    ]


def may_be_submission(item: Item, exercise: Exercise) -> bool:
    """Whether an item is of a kind that can be handed in."""
    return item.is_program or (bool(exercise.files) and (item.is_zip or item.kind == listing.FOLDER))


def _sureness(file: HandIn, exercise: Exercise, seen: FileSummary) -> int:
    if not may_be_submission(file.item, exercise):
        return 0
    called = file.file_name.lower()
    if called in map(str.lower, exercise.starters):
        return NAMED
    if exercise.id in called:
        return CALLED_ALIKE
    return BY_CONTENT if seen.found else 0


def _join_problems(problems: Sequence[str]) -> str:
    more = len(problems) - _MOST_TOLD
    return "; ".join(problems[:_MOST_TOLD]) + (f"; and {more} more" if more > 0 else "")


def _nothing_of(student: str, units: Sequence[HandIn]) -> Entry:
    """What is known of a student without a submission."""
    unit = next((unit for unit in units if not unit.odd), units[0])
    return Entry(student, "", "", one_line(unit.name), platform=_platform_of(unit))


def _platform_of(unit: HandIn) -> dict[str, str]:
    return {key: one_line(value) for key, value in unit.platform.items()}


def _list_other_files(reasons: Mapping[str, str], rest: Sequence[str]) -> list[str]:
    """What else a student handed in: what might have been chosen, then other programs, then the rest."""
    named = [f"{one_line(path)} ({why})" for path, why in reasons.items()]
    named += [one_line(path) for path in sorted(rest, key=lambda path: (not text.kind_of_file(path), path))]
    more = len(named) - _MOST_OTHERS
    return named[:_MOST_OTHERS] + ([f"{more} more"] if more > 0 else [])


def _modified_at(path: Path) -> float:
    try:
        return max(file.lstat().st_mtime for file in (path.iterdir() if path.is_dir() else [path]))
    except (OSError, ValueError):  # it has gone, or is empty
        return 0.0


def parts_of_kit(paths: Iterable[str]) -> set[str]:
    """Those of a student's files that came with the course; the folder of exercises is where students work."""
    all_paths = list(paths)
    packages = [path.removesuffix(_PACKAGE) for path in all_paths if f"/{path}".endswith(f"/{_PACKAGE}")]
    found: set[str] = set()
    for root in packages[:_MOST_COPIES]:
        below = [(path, path[len(root) :]) for path in all_paths if path.startswith(root)]
        whole = any(_EXERCISE.fullmatch(inside) for _, inside in below)
        found.update(path for path, inside in below if _is_the_kits(inside, whole=whole))
    return found


def _is_the_kits(path: str, *, whole: bool) -> bool:
    if path.startswith("course_kit/"):
        return True
    path = path.removeprefix(f"{environment.LEARNER_FOLDER}/")  # `./course lab` copies lessons there
    return whole and (path.startswith(_FOLDERS) or _LESSON.fullmatch(path) is not None or path == "hatch_build.py")

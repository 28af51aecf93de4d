"""Submissions that look alike: identical ones, and those that share most of what is their own.

Likeness is a reason to look, never a proof: small exercises have few good solutions. Starters that were handed in as
they were, and the work of a group, are alike by themselves and left out.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from contextlib import suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.intake import known_starters
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record
    from course_kit.grading.exercise import Exercise

THRESHOLD = 0.7  # of the fingerprints of two programs together, those they share
_FEWEST = 10  # fingerprints; what is shorter is alike by itself
_COMMON = 0.1  # of all different programs: what so many share is how one writes it
_COMMON_AT_LEAST = 30  # programs
_RARE = 40  # programs; only fingerprints that no more have bring two together, which bounds the work in large classes


@dataclass(frozen=True)
class Pair:
    """Two submissions that look alike; `similarity` from 0 to 1 is shared by `shared` fingerprints."""

    first: Record
    second: Record
    similarity: float
    shared: int


@dataclass(frozen=True)
class LookAlikes:
    """What was found.

    Attributes:
        identical: groups of two or more whose files are the same.
        pairs: others that look alike, the most similar first; one stands for all that are the same as it.
        compared: how many different programs were compared.
        unread: how many could not be read or are too short.
        left_out: titles of exercises in which alike answers are to be expected.
    """

    identical: tuple[tuple[Record, ...], ...]
    pairs: tuple[Pair, ...]
    compared: int
    unread: int
    left_out: tuple[str, ...]


def find(book: Gradebook) -> LookAlikes:
    """Compare all submissions, each exercise's with one another."""
    identical: list[tuple[Record, ...]] = []
    pairs: list[Pair] = []
    compared = unread = 0
    for exercise in book.exercises:
        if not exercise.class_name:
            continue
        groups = _without_starters(_groups(book.of(exercise.id)), book, exercise)
        identical += [tuple(group) for group in groups if len(group) > 1 and not _is_a_team(group)]
        alike = _alike(book, exercise, [group[0] for group in groups])
        pairs += alike.pairs
        compared += alike.compared
        unread += len(groups) - alike.compared
    pairs.sort(key=lambda pair: (-pair.similarity, -pair.shared, pair.first.entry.student, pair.second.entry.student))
    left_out = tuple(exercise.title for exercise in book.exercises if not exercise.class_name)
    return LookAlikes(tuple(identical), tuple(pairs), compared, unread, left_out)


def _groups(records: list[Record]) -> list[list[Record]]:
    """Records of the same bytes together; what could not be read is like nothing else."""
    groups: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        groups[record.digest or record.entry.source].append(record)
    return list(groups.values())


def _without_starters(groups: list[list[Record]], book: Gradebook, exercise: Exercise) -> list[list[Record]]:
    """Those who have written something: a starter handed in as it was is like every other one."""
    starters = known_starters.of(exercise, known_starters.read())
    if book.root is None:
        return groups
    with Reader() as reader:
        return [
            group for group in groups if _identity(book.root / group[0].entry.source, exercise, reader) not in starters
        ]


def _identity(path: Path, exercise: Exercise, reader: Reader) -> str:
    with suppress(UnreadableError, GradingError), Copy(path) as copy:
        return reader.glance(copy, exercise).identity
    return ""


def _is_a_team(records: Sequence[Record]) -> bool:
    """Whether all of these handed in together."""
    teams = {record.entry.platform.get("group", "") for record in records}
    return len(teams) == 1 and teams != {""}


@dataclass(frozen=True)
class _Alike:
    pairs: list[Pair]
    compared: int


def _alike(book: Gradebook, exercise: Exercise, records: list[Record]) -> _Alike:
    """Compare different files of one exercise."""
    if book.root is None:
        return _Alike([], 0)
    given: frozenset[int] = frozenset()
    same: dict[frozenset[int], list[Record]] = defaultdict(list)
    with Reader() as reader:
        for name in (exercise.starter, exercise.notebook):
            given |= _of_file(exercise.folder / name, exercise, reader)
        for record in records:
            path = book.root / record.entry.source
            prints = frozenset() if record.status == "unreadable" else _of_file(path, exercise, reader)
            same[prints - given].append(record)
    long_enough = {prints: group for prints, group in same.items() if len(prints) >= _FEWEST}
    pairs = [
        Pair(first, other, 1.0, len(prints))
        for prints, (first, *others) in long_enough.items()
        for other in others
        if not _is_a_team((first, other))
    ]
    own = _without_common(list(long_enough))
    kept = [(group[0], prints) for group, prints in zip(long_enough.values(), own, strict=True)]
    pairs += _similar([one for one in kept if len(one[1]) >= _FEWEST])
    compared = sum(
        len(group)
        for (_, prints), group in zip(kept, long_enough.values(), strict=True)
        if len(prints) >= _FEWEST or len(group) > 1
    )
    return _Alike(pairs, compared)


def _of_file(path: Path, exercise: Exercise, reader: Reader) -> frozenset[int]:
    with suppress(UnreadableError, GradingError), Copy(path) as copy:
        return reader.fingerprints(copy, exercise)
    return frozenset()


def _without_common(programs: list[frozenset[int]]) -> list[frozenset[int]]:
    """Of each program what is its own, not what many write."""
    counts = Counter(one for prints in programs for one in prints)
    most = max(_COMMON_AT_LEAST, int(_COMMON * len(programs)))
    common = {one for one, count in counts.items() if count > most}
    return [prints - common for prints in programs]


def _similar(programs: list[tuple[Record, frozenset[int]]]) -> Iterator[Pair]:
    """Pairs above the threshold, among those who share a rare fingerprint."""
    having: dict[int, list[int]] = defaultdict(list)
    for place, (_, prints) in enumerate(programs):
        for one in prints:
            having[one].append(place)
    for place, (record, prints) in enumerate(programs):
        rare = (having[one] for one in prints if len(having[one]) <= _RARE)
        for other in sorted({number for numbers in rare for number in numbers if number > place}):
            its_record, its_prints = programs[other]
            shared = len(prints & its_prints)
            similarity = shared / (len(prints) + len(its_prints) - shared)
            if similarity >= THRESHOLD and not _is_a_team((record, its_record)):
                yield Pair(record, its_record, similarity, shared)

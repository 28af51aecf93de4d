"""Submissions that look alike: identical ones, and those that share most of what is their own.

Likeness is a reason to look, never a proof: small exercises have few good solutions.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from course_kit.grading import submission
from course_kit.grading.exports.fingerprints import fingerprints

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from course_kit.grading.classroom.gradebook import Gradebook
    from course_kit.grading.classroom.records import Record
    from course_kit.grading.exercise import Exercise

THRESHOLD = 0.7  # of the fingerprints of two programs together, those they share
_FEWEST = 10  # fingerprints; what is shorter is alike by itself
_COMMON = 0.1  # of all programs: what so many share is how one writes it
_COMMON_AT_LEAST = 30  # programs; also bounds the work, as each fingerprint makes pairs of all who have it


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
        pairs: others that look alike, the most similar first; one stands for all that are identical to it.
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
        groups = _groups(book.of(exercise.id))
        identical += [tuple(group) for group in groups if len(group) > 1]
        own = _own_fingerprints(book, exercise, [group[0] for group in groups])
        compared += len(own)
        unread += len(groups) - len(own)
        pairs += _pairs([record for record, _ in own], [prints for _, prints in own])
    pairs.sort(key=lambda pair: (-pair.similarity, -pair.shared, pair.first.entry.student, pair.second.entry.student))
    left_out = tuple(exercise.title for exercise in book.exercises if not exercise.class_name)
    return LookAlikes(tuple(identical), tuple(pairs), compared, unread, left_out)


def _groups(records: list[Record]) -> list[list[Record]]:
    """Records of the same bytes together; what could not be read is like nothing else."""
    groups: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        groups[record.digest or record.entry.source].append(record)
    return list(groups.values())


def _own_fingerprints(
    book: Gradebook, exercise: Exercise, records: list[Record]
) -> list[tuple[Record, frozenset[int]]]:
    """What is each program's own: neither the starter's nor what many have."""
    if book.root is None:
        return []
    given: frozenset[int] = frozenset()
    for name in (exercise.starter, exercise.notebook):
        given |= _of_file(exercise.folder / name, exercise)
    all_prints = [(record, _of_file(book.root / record.entry.source, exercise) - given) for record in records]
    counts = Counter(one for _, prints in all_prints for one in prints)
    most = max(_COMMON_AT_LEAST, int(_COMMON * len(records)))
    common = {one for one, count in counts.items() if count > most}
    left = [(record, prints - common) for record, prints in all_prints]
    return [(record, prints) for record, prints in left if len(prints) >= _FEWEST]


def _of_file(path: Path, exercise: Exercise) -> frozenset[int]:
    with suppress(submission.UnreadableError, OSError):
        return fingerprints(submission.read(path, exercise.id).source)
    return frozenset()


def _pairs(records: list[Record], prints: list[frozenset[int]]) -> Iterator[Pair]:
    """Pairs above the threshold; only those are looked at that share a fingerprint."""
    having: dict[int, list[int]] = defaultdict(list)
    for number, own in enumerate(prints):
        for one in own:
            having[one].append(number)
    shared = Counter(pair for numbers in having.values() for pair in combinations(numbers, 2))
    for (first, second), count in shared.items():
        similarity = count / (len(prints[first]) + len(prints[second]) - count)
        if similarity >= THRESHOLD:
            yield Pair(records[first], records[second], similarity, count)

"""Submissions that look alike: identical ones, and those that share most of what is their own.

Likeness is a reason to look, never a proof: small exercises have few good solutions. Starters that were handed in as
they were, and the work of a group, are alike by themselves and left out.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit.classroom.exports.program_texts import ProgramTexts
from course_kit.classroom.intake import known_starters

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

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
    """What was found."""

    identical: tuple[tuple[Record, ...], ...]  # groups of two or more whose files are the same
    # others that look alike, the most similar first; one stands for all that are the same as it
    pairs: tuple[Pair, ...]
    compared: int  # how many different programs were compared
    unread: int  # how many could not be read or are too short
    left_out: tuple[str, ...]  # titles of exercises in which alike answers are to be expected


def find(book: Gradebook, texts: ProgramTexts | None = None) -> LookAlikes:
    """Compare all submissions, each exercise's with one another."""
    if texts is None:
        with ProgramTexts(book) as opened:
            return find(book, opened)
    identical: list[tuple[Record, ...]] = []
    pairs: list[Pair] = []
    compared = unread = 0
    for exercise in book.exercises:
        if not exercise.class_name:
            continue
        groups = _without_starters(_groups(book.of(exercise.id)), exercise, texts)
        identical += [tuple(records) for records, _ in groups if len(records) > 1 and not _is_a_team(records)]
        alike = _alike(exercise, [(records[0], prints) for records, prints in groups], texts)
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


def _without_starters(
    groups: list[list[Record]], exercise: Exercise, texts: ProgramTexts
) -> list[tuple[list[Record], frozenset[int]]]:
    """Those who have written something, and its fingerprints: a starter handed in as it was is like every other one."""
    starters = known_starters.of(exercise, known_starters.read())
    read = [(group, texts.fingerprints(group[0])) for group in groups]
    return [(group, found.prints) for group, found in read if found.identity not in starters]


def _is_a_team(records: Sequence[Record]) -> bool:
    """Whether all of these handed in together."""
    teams = {record.entry.platform.get("group", "") for record in records}
    return len(teams) == 1 and teams != {""}


@dataclass(frozen=True)
class _Alike:
    pairs: list[Pair]
    compared: int


def _alike(exercise: Exercise, programs: list[tuple[Record, frozenset[int]]], texts: ProgramTexts) -> _Alike:
    """Compare different files of one exercise."""
    if not texts.are_at_hand:
        return _Alike([], 0)
    given: frozenset[int] = frozenset()
    for name in (exercise.starter, exercise.notebook):
        given |= texts.of_file(exercise.folder / name, exercise).prints
    same: dict[frozenset[int], list[Record]] = defaultdict(list)
    for record, prints in programs:
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

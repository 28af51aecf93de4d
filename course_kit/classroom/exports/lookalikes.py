"""Groups of submissions that look alike: each is the same as another one in it, or shares most of what is its own.

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
    from collections.abc import Iterable, Iterator, Sequence

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
    """The first submission of a group and another one; `similarity` is from 0 to 1."""

    first: Record
    second: Record
    similarity: float

    @property
    def is_same_file(self) -> bool:
        """Whether there is nothing to compare."""
        return self.first.digest == self.second.digest


Group = tuple[Pair, ...]  # the first of a group beside each other one


@dataclass(frozen=True)
class LookAlikes:
    """What was found."""

    groups: tuple[Group, ...]  # the most similar first
    compared: int  # how many different programs were compared
    unread: int  # how many could not be read or are too short
    left_out: tuple[str, ...]  # titles of exercises in which alike answers are to be expected

    @property
    def pairs(self) -> list[Pair]:
        """Those that can be laid side by side."""
        return [pair for group in self.groups for pair in group if not pair.is_same_file]


def find(book: Gradebook, texts: ProgramTexts | None = None) -> LookAlikes:
    """Compare all submissions, each exercise's with one another."""
    if texts is None:
        with ProgramTexts(book) as opened:
            return find(book, opened)
    groups: list[Group] = []
    compared = unread = 0
    for exercise in book.exercises:
        if not exercise.class_name:
            continue
        programs = list(_programs(book.of(exercise.id), exercise, texts))
        groups += _groups(programs)
        long_enough = sum(len(prints) >= _FEWEST for _, prints in programs)
        compared += long_enough
        unread += len(programs) - long_enough
    groups.sort(key=lambda group: (-group[0].similarity, -len(group), group[0].first.entry.student))
    left_out = tuple(exercise.title for exercise in book.exercises if not exercise.class_name)
    return LookAlikes(tuple(groups), compared, unread, left_out)


def _programs(
    records: Iterable[Record], exercise: Exercise, texts: ProgramTexts
) -> Iterator[tuple[list[Record], frozenset[int]]]:
    """Records of the same bytes together, with the fingerprints that they do not have of the starter.

    A starter handed in as it was is like every other one, and left out. What could not be read has no fingerprints.
    """
    same: dict[str, list[Record]] = defaultdict(list)
    for record in records:
        same[_file(record)].append(record)
    starters = known_starters.of(exercise, known_starters.read())
    given: frozenset[int] = frozenset()
    for name in (exercise.starter, exercise.notebook) if texts.are_at_hand else ():
        given |= texts.of_file(exercise.folder / name, exercise).prints
    for group in same.values():
        found = texts.fingerprints(group[0])
        if found.identity not in starters:
            yield group, found.prints - given


def _file(record: Record) -> str:
    """Equal for files of the same bytes; what could not be read is like nothing else."""
    return record.digest or record.entry.source


def _groups(programs: Sequence[tuple[list[Record], frozenset[int]]]) -> Iterator[Group]:
    """Programs that are alike, or alike to others that are; not those of one team."""
    together: dict[object, list[Record]] = defaultdict(list)  # by what is the same: fingerprints, else the file
    for records, prints in programs:
        together[prints if len(prints) >= _FEWEST else _file(records[0])] += records
    own = _without_common([key if isinstance(key, frozenset) else frozenset() for key in together])
    leaders = list(range(len(own)))
    for one, other in _similar(own):
        old, new = leaders[other], leaders[one]
        leaders = [new if leader == old else leader for leader in leaders]
    members: dict[int, list[tuple[Record, frozenset[int]]]] = defaultdict(list)
    for leader, prints, records in zip(leaders, own, together.values(), strict=True):
        members[leader] += [(record, prints) for record in records]
    for found in members.values():
        if len(found) > 1 and not _is_a_team([record for record, _ in found]):
            (first, its_prints), *others = sorted(found, key=lambda one: one[0].entry.student)
            pairs = [Pair(first, record, _similarity(its_prints, prints)) for record, prints in others]
            yield tuple(sorted(pairs, key=lambda pair: -pair.similarity))


def _is_a_team(records: Sequence[Record]) -> bool:
    """Whether all of these handed in together."""
    teams = {record.entry.platform.get("group", "") for record in records}
    return len(teams) == 1 and teams != {""}


def _without_common(programs: list[frozenset[int]]) -> list[frozenset[int]]:
    """Of each program what is its own, not what many write."""
    counts = Counter(one for prints in programs for one in prints)
    most = max(_COMMON_AT_LEAST, int(_COMMON * len(programs)))
    common = {one for one, count in counts.items() if count > most}
    return [prints - common for prints in programs]


def _similar(programs: Sequence[frozenset[int]]) -> Iterator[tuple[int, int]]:
    """Places of programs above the threshold, among those who share a rare fingerprint."""
    having: dict[int, list[int]] = defaultdict(list)
    for place, prints in enumerate(programs):
        for one in prints if len(prints) >= _FEWEST else ():
            having[one].append(place)
    for place, prints in enumerate(programs):
        rare = (having[one] for one in prints if len(having[one]) <= _RARE)
        for other in sorted({number for numbers in rare for number in numbers if number > place}):
            if _similarity(prints, programs[other]) >= THRESHOLD:
                yield place, other


def _similarity(one: frozenset[int], other: frozenset[int]) -> float:
    return len(one & other) / len(one | other) if one != other else 1.0

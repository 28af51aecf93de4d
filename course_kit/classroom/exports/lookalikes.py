"""Groups of submissions that look alike: each equals another in it, or shares most of what it added to the starter.

Likeness is a reason to look, never a proof: small exercises have few good solutions. Starters that were handed in as
they were, and the work of a group, are alike by themselves and left out.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from contextlib import suppress
from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.exports.report_page import LONGEST
from course_kit.grading.errors import GradingError
from course_kit.grading.model.submission import UnreadableError
from course_kit.grading.reading import FileSummary, Reader, copy_file, starter_identities
from course_kit.process import Closable
from course_kit.reader.fingerprints import token_shapes
from course_kit.text.templates import render_template

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from course_kit.classroom.exports.attention import StudentLabel
    from course_kit.classroom.records import Gradebook, GradeRecord
    from course_kit.grading.model.exercise import Exercise

THRESHOLD = 0.7  # of the fingerprints of two programs together, those they share
_FEWEST = 10  # fingerprints; what is shorter is alike by itself
_COMMON = 0.1  # of all different programs: what so many share is how one writes it
_COMMON_AT_LEAST = 30  # programs
_RARE = 40  # programs; only fingerprints that no more have bring two together, which bounds the work in large classes
FOLDER = "lookalikes"
MOST_PAIRS = 60
_MOST_LINES = 400  # of each program; comparing takes the square of it
_shape = lru_cache(maxsize=8192)(token_shapes)  # a program is compared with many others, and much is alike
_TEMPLATES = Path(__file__).with_name("templates")


class ProgramTexts(Closable):
    """The programs of a class: each is read when it is asked for, if nobody has read it yet; for one thread."""

    def __init__(self, book: Gradebook) -> None:
        self._root, self._elsewhere = book.root, book.earlier
        self._exercises = {exercise.id: exercise for exercise in book.exercises}
        self._reader = Reader() if book.reader is None else Reader(memory=book.reader.memory)

    @property
    def are_at_hand(self) -> bool:
        """Whether there is anything to read."""
        return self._root is not None

    def fingerprints(self, record: GradeRecord) -> FileSummary:
        """Those of a submission, and its program; none of what cannot be read."""
        if self._root is None or record.status == "unreadable" or record.entry.exercise in self._elsewhere:
            return FileSummary()
        return self.of_file(self._root / record.entry.source, self._exercises[record.entry.exercise])

    def of_file(self, path: Path, exercise: Exercise) -> FileSummary:
        """The fingerprints of any file that is read as a submission for an exercise."""
        with suppress(UnreadableError, GradingError), copy_file(path, several=bool(exercise.files)) as copy:
            return self._reader.summarize(copy, exercise)
        return FileSummary()

    def lines(self, record: GradeRecord) -> list[str]:
        """A program's lines; none of what cannot be read."""
        program = self.fingerprints(record).program
        return program.source.split("\n") if program else []

    def close(self) -> None:
        """End the process that reads. Safe to call twice."""
        self._reader.close()


@dataclass(frozen=True)
class AlikePair:
    """The first submission of a group and one of the others; `similarity` is from 0 to 1."""

    first: GradeRecord
    second: GradeRecord
    similarity: float

    @property
    def is_same_file(self) -> bool:
        """Whether there is nothing to compare."""
        return self.first.digest == self.second.digest


Group = tuple[AlikePair, ...]  # the first of a group beside each other one


@dataclass(frozen=True)
class LookAlikes:
    """What was found."""

    groups: tuple[Group, ...]  # the most similar first
    compared: int  # how many different programs were compared
    unread: int  # how many could not be read or are too short
    left_out: tuple[str, ...]  # titles of exercises in which similar answers are expected

    @property
    def pairs(self) -> list[AlikePair]:
        """Those that can be laid side by side."""
        return [pair for group in self.groups for pair in group if not pair.is_same_file]


def find_lookalikes(book: Gradebook, texts: ProgramTexts | None = None) -> LookAlikes:
    """Compare all submissions, each exercise's with one another."""
    if texts is None:
        with ProgramTexts(book) as opened:
            return find_lookalikes(book, opened)
    groups: list[Group] = []
    compared = unread = 0
    for exercise in book.exercises:
        if exercise.variable:
            continue
        programs = list(_programs(book.records_of(exercise.id), exercise, texts))
        groups += _groups(programs)
        long_enough = sum(len(prints) >= _FEWEST for _, prints in programs)
        compared += long_enough
        unread += len(programs) - long_enough
    groups.sort(key=lambda group: (-group[0].similarity, -len(group), group[0].first.entry.student))
    left_out = tuple(exercise.title for exercise in book.exercises if exercise.variable)
    return LookAlikes(tuple(groups), compared, unread, left_out)


def _programs(
    records: Iterable[GradeRecord], exercise: Exercise, texts: ProgramTexts
) -> Iterator[tuple[list[GradeRecord], frozenset[int]]]:
    """Records of the same bytes together, with the fingerprints that they do not have of the starter.

    A starter handed in as it was is like every other one, and left out. What could not be read has no fingerprints.
    """
    same: dict[str, list[GradeRecord]] = defaultdict(list)
    for record in records:
        same[_file(record)].append(record)
    starters = starter_identities(exercise)
    given: frozenset[int] = frozenset()
    for name in ("" if exercise.files else exercise.starter, exercise.notebook) if texts.are_at_hand else ():
        given |= texts.of_file(exercise.folder / name, exercise).prints
    for group in same.values():
        found = texts.fingerprints(group[0])
        if found.identity not in starters:
            yield group, found.prints - given


def _file(record: GradeRecord) -> str:
    """Equal for files of the same bytes; what could not be read is like nothing else."""
    return record.digest or record.entry.source


def _groups(programs: Sequence[tuple[list[GradeRecord], frozenset[int]]]) -> Iterator[Group]:
    """Programs that are alike, or alike to others that are; not those of one team."""
    together: dict[object, list[GradeRecord]] = defaultdict(list)  # by what is the same: fingerprints, else the file
    for records, prints in programs:
        together[prints if len(prints) >= _FEWEST else _file(records[0])] += records
    own = _without_common([key if isinstance(key, frozenset) else frozenset() for key in together])
    leaders = list(range(len(own)))
    for place, other in _find_similar_programs(own):
        old, new = leaders[other], leaders[place]
        leaders = [new if leader == old else leader for leader in leaders]
    members: dict[int, list[tuple[GradeRecord, frozenset[int]]]] = defaultdict(list)
    for leader, prints, records in zip(leaders, own, together.values(), strict=True):
        members[leader] += [(record, prints) for record in records]
    for found in members.values():
        if len(found) > 1 and not _is_a_team([record for record, _ in found]):
            (first, its_prints), *others = sorted(found, key=lambda pair: pair[0].entry.student)
            pairs = [AlikePair(first, record, _similarity(its_prints, prints)) for record, prints in others]
            yield tuple(sorted(pairs, key=lambda pair: -pair.similarity))


def _is_a_team(records: Sequence[GradeRecord]) -> bool:
    """Whether all of these handed in together."""
    teams = {record.entry.platform.get("group", "") for record in records}
    return len(teams) == 1 and teams != {""}


def _without_common(programs: list[frozenset[int]]) -> list[frozenset[int]]:
    """Of each program what is its own, not what many write."""
    counts = Counter(digest for prints in programs for digest in prints)
    most = max(_COMMON_AT_LEAST, int(_COMMON * len(programs)))
    common = {digest for digest, count in counts.items() if count > most}
    return [prints - common for prints in programs]


def _find_similar_programs(programs: Sequence[frozenset[int]]) -> Iterator[tuple[int, int]]:
    """Places of programs above the threshold, among those who share a rare fingerprint."""
    having: dict[int, list[int]] = defaultdict(list)
    for place, prints in enumerate(programs):
        for digest in prints if len(prints) >= _FEWEST else ():
            having[digest].append(place)
    for place, prints in enumerate(programs):
        rare = (having[digest] for digest in prints if len(having[digest]) <= _RARE)
        for other in sorted({number for numbers in rare for number in numbers if number > place}):
            if _similarity(prints, programs[other]) >= THRESHOLD:
                yield place, other


def _similarity(prints: frozenset[int], other: frozenset[int]) -> float:
    return len(prints & other) / len(prints | other) if prints != other else 1.0


@dataclass(frozen=True)
class LinePair:
    """Two lines beside each other, with their numbers; a number is 0 where one side has no line."""

    first: int
    first_text: str
    second: int
    second_text: str
    same: bool  # both lines are the same but for names, values, comments and layout


def link_to_pair(place: int) -> str:
    """Where the page of the pair at a place of the list lies, seen from the class page."""
    return f"{FOLDER}/{place + 1}.html"


def pair_pages(
    texts: ProgramTexts, pairs: Sequence[AlikePair], called: Mapping[str, StudentLabel]
) -> Iterator[tuple[str, str]]:
    """Path and text of a page for each pair, as far as `MOST_PAIRS` and while the submissions are at hand."""
    if not texts.are_at_hand:
        return
    template = _TEMPLATES / "comparison.html"
    for place, pair in enumerate(pairs[:MOST_PAIRS]):
        sides = [[line[:LONGEST] for line in texts.lines(record)] for record in (pair.first, pair.second)]
        rows = list(compare_programs(*(lines[:_MOST_LINES] for lines in sides)))
        cut = any(len(lines) > _MOST_LINES for lines in sides)
        names = [str(called[record.entry.student]) for record in (pair.first, pair.second)]
        most = _MOST_LINES if cut else 0
        yield link_to_pair(place), str(render_template(template, pair=pair, rows=rows, names=names, most=most))


def compare_programs(first: Sequence[str], second: Sequence[str]) -> Iterator[LinePair]:
    """Rows for two programs; lines of the same shape stand beside each other, the others between them."""
    at = at_other = 0
    for place, other in [*_pairs(first, second), (len(first), len(second))]:
        for left, right in zip_longest(range(at, place), range(at_other, other)):
            yield _row(first, left, second, right, same=False)
        if place < len(first):
            yield _row(first, place, second, other, same=True)
        at, at_other = place + 1, other + 1


def _pairs(first: Sequence[str], second: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Lines of the same shape, in order; blank lines and comments tell nothing."""
    ours, theirs = (
        [(place, found) for place, line in enumerate(lines) if (found := _shape(line))] for lines in (first, second)
    )
    matcher = SequenceMatcher(None, [shape for _, shape in ours], [shape for _, shape in theirs], autojunk=False)
    for start, other, size in matcher.get_matching_blocks():
        for step in range(size):
            yield ours[start + step][0], theirs[other + step][0]


def _row(first: Sequence[str], place: int | None, second: Sequence[str], other: int | None, *, same: bool) -> LinePair:
    return LinePair(*_number_line(first, place), *_number_line(second, other), same)


def _number_line(lines: Sequence[str], place: int | None) -> tuple[int, str]:
    return (0, "") if place is None else (place + 1, lines[place])

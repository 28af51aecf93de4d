"""Two programs that look alike, side by side: a page for each pair, lines of the same shape beside each other."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import SequenceMatcher
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.grading.render.program import LONGEST
from course_kit.reader.fingerprints import shape
from course_kit.text.templates import render

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from course_kit.classroom.exports.attention import StudentLabel
    from course_kit.classroom.exports.lookalikes import Pair
    from course_kit.classroom.exports.program_texts import ProgramTexts

FOLDER = "lookalikes"
MOST_PAIRS = 60
_MOST_LINES = 400  # of each program; comparing takes the square of it
_TEMPLATES = Path(__file__).with_name("templates")


@dataclass(frozen=True)
class LinePair:
    """Two lines beside each other, with their numbers; a number is 0 where one side has no line."""

    first: int
    first_text: str
    second: int
    second_text: str
    same: bool  # both lines are the same but for names, values, comments and layout


def link(place: int) -> str:
    """Where the page of the pair at a place of the list lies, seen from the class page."""
    return f"{FOLDER}/{place + 1}.html"


def pages(texts: ProgramTexts, pairs: Sequence[Pair], called: Mapping[str, StudentLabel]) -> Iterator[tuple[str, str]]:
    """Path and text of a page for each pair, as far as `MOST_PAIRS` and while the submissions are at hand."""
    if not texts.are_at_hand:
        return
    template = _TEMPLATES / "comparison.html"
    for place, pair in enumerate(pairs[:MOST_PAIRS]):
        sides = [[line[:LONGEST] for line in texts.lines(one)] for one in (pair.first, pair.second)]
        rows = list(compare(*(lines[:_MOST_LINES] for lines in sides)))
        cut = any(len(lines) > _MOST_LINES for lines in sides)
        names = [str(called[one.entry.student]) for one in (pair.first, pair.second)]
        yield link(place), str(render(template, pair=pair, rows=rows, names=names, most=_MOST_LINES if cut else 0))


def compare(first: Sequence[str], second: Sequence[str]) -> Iterator[LinePair]:
    """Rows for two programs; lines of the same shape stand beside each other, the others between them."""
    at = at_other = 0
    for one, other in [*_pairs(first, second), (len(first), len(second))]:
        for left, right in zip_longest(range(at, one), range(at_other, other)):
            yield _row(first, left, second, right, same=False)
        if one < len(first):
            yield _row(first, one, second, other, same=True)
        at, at_other = one + 1, other + 1


@lru_cache(maxsize=8192)
def _shape(line: str) -> tuple[str, ...]:
    """Its shape; a program is compared with many others, and much is alike."""
    return shape(line)


def _pairs(first: Sequence[str], second: Sequence[str]) -> Iterator[tuple[int, int]]:
    """Lines of the same shape, in order; blank lines and comments tell nothing."""
    ours, theirs = (
        [(place, found) for place, line in enumerate(lines) if (found := _shape(line))] for lines in (first, second)
    )
    matcher = SequenceMatcher(None, [one for _, one in ours], [one for _, one in theirs], autojunk=False)
    for start, other, size in matcher.get_matching_blocks():
        for step in range(size):
            yield ours[start + step][0], theirs[other + step][0]


def _row(first: Sequence[str], one: int | None, second: Sequence[str], other: int | None, *, same: bool) -> LinePair:
    return LinePair(
        0 if one is None else one + 1,
        "" if one is None else first[one],
        0 if other is None else other + 1,
        "" if other is None else second[other],
        same,
    )

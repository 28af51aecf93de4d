"""Two programs that look alike, side by side: a page for each pair, lines of the same shape beside each other."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from difflib import SequenceMatcher
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.classroom.exports.lookalikes import Pair
from course_kit.grading.errors import GradingError
from course_kit.grading.reading import Reader
from course_kit.grading.submission import Copy, UnreadableError
from course_kit.reader.fingerprints import shape
from course_kit.text.templates import render

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

FOLDER = "lookalikes"
MOST_PAIRS = 60
_MOST_LINES = 400  # of each program; comparing takes the square of it
_TEMPLATES = Path(__file__).with_name("templates")


@dataclass(frozen=True)
class Row:
    """Two lines beside each other, with their numbers; a number is 0 where one side has no line.

    Attributes:
        same: both lines are the same but for names, values, comments and layout.
    """

    first: int
    first_text: str
    second: int
    second_text: str
    same: bool


def link(place: int) -> str:
    """Where the page of the pair at a place of the list lies, seen from the class page."""
    return f"{FOLDER}/{place + 1}.html"


def pages(book: Gradebook, pairs: Sequence[Pair], called: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Path and text of a page for each pair, as far as `MOST_PAIRS` and while the submissions are at hand.

    Args:
        book: the class.
        pairs: those to compare, in the order in which the class page lists them.
        called: what each student is called.
    """
    if book.root is None or not pairs:
        return
    template = _TEMPLATES / "comparison.html"
    with Reader() as reader:
        for place, pair in enumerate(pairs[:MOST_PAIRS]):
            sides = [_lines(book, one, reader) for one in (pair.first, pair.second)]
            rows = list(compare(*(lines[:_MOST_LINES] for lines in sides)))
            cut = any(len(lines) > _MOST_LINES for lines in sides)
            names = [called[one.entry.student] for one in (pair.first, pair.second)]
            yield link(place), str(render(template, pair=pair, rows=rows, names=names, most=_MOST_LINES if cut else 0))


def compare(first: Sequence[str], second: Sequence[str]) -> Iterator[Row]:
    """Rows for two programs; lines of the same shape stand beside each other."""
    shapes = [[shape(line) for line in lines] for lines in (first, second)]
    for kind, start, end, other, other_end in SequenceMatcher(None, *shapes, autojunk=False).get_opcodes():
        for one, two in zip_longest(range(start, end), range(other, other_end)):
            yield Row(
                0 if one is None else one + 1,
                "" if one is None else first[one],
                0 if two is None else two + 1,
                "" if two is None else second[two],
                same=kind == "equal" and bool(shapes[0][one or 0]),
            )


def _lines(book: Gradebook, record: Record, reader: Reader) -> list[str]:
    exercise = next(one for one in book.exercises if one.id == record.entry.exercise)
    assert book.root is not None
    with suppress(UnreadableError, GradingError), Copy(book.root / record.entry.source) as copy:
        return reader.read(copy, exercise).source.split("\n")
    return []

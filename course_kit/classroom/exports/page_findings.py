"""The class page's second half, what to look into: diagnoses, look-alikes, slow and large ones, what was left."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.classroom.exports import counts, lookalikes
from course_kit.classroom.exports.markup import TableCell, amount, many, person, shown, table
from course_kit.classroom.exports.page_class import Part
from course_kit.classroom.exports.results import problem
from course_kit.classroom.exports.texts import html
from course_kit.grading.diagnosis import catalogue

if TYPE_CHECKING:
    from collections.abc import Sequence

    from course_kit.classroom.gradebook import Gradebook
    from course_kit.classroom.records import Record

_MOST_LISTED = 10
_MOST_PAIRS = 500
_PAIRS_AT_ONCE = 20
_PALE = 4  # submissions; fewer do not make a cell dark, even where there are no more
_KB = 1000


def worries(book: Gradebook) -> list[Part]:
    """What is missing from the grades."""
    return [
        Part("failed", "Could not be graded", _failed(book)),
        Part("dropped", "Handed in, but not graded", _dropped(book)),
    ]


def sections(book: Gradebook) -> list[Part]:
    """Diagnoses, look-alikes and extremes."""
    return [
        Part("diagnoses", "Diagnoses", _diagnoses(book)),
        Part("alike", "Look-alikes", _alike(book)),
        Part("extremes", "Slowest and largest", _extremes(book)),
    ]


def absent(book: Gradebook) -> list[Part]:
    """Who has handed in nothing, what looks unlike the rest, and what is no submission."""
    return [
        Part("odd", "Entries that do not fit the layout", _odd(book)),
        Part("missing", "Missing submissions", _missing(book)),
        Part("left", "Files that were not recognised as submissions", _left(book)),
    ]


def _diagnoses(book: Gradebook) -> str:
    """A heat map: over the exercises, and for each over how well its submissions did."""
    parts = []
    if len(book.exercises) > 1:
        titles = [html(exercise.title) for exercise in book.exercises]
        rows = counts.diagnoses_by_exercise(book)
        parts.append(_heat_map("Submissions with a diagnosis, by exercise", titles, rows))
    for exercise in book.exercises:
        rows = counts.diagnoses_by_band(book.graded(exercise.id))
        title = f"{html(exercise.title)}: submissions with a diagnosis, by score"
        parts.append(_heat_map(title, [html(band) for band in counts.BANDS], rows))
    if not any(parts):
        return "<p>No submission has a diagnosis.</p>" if book.records else ""
    return "<p>The stronger a cell's colour, the more submissions have it; the number says how many.</p>" + "".join(
        parts
    )


def _heat_map(caption: str, columns: Sequence[str], rows: dict[str, list[int]]) -> str:
    if not rows:
        return ""
    most = max(_PALE, *(max(row) for row in rows.values()))
    known = catalogue.catalogue()
    listed = []
    for code, row in rows.items():
        found = known.get(code)
        name = f"{html(found.title)} <code>{html(code)}</code>" if found else f"<code>{html(code)}</code>"
        cells = [_heat(count, most) for count in row]
        listed.append([TableCell(name, code), *cells, amount(sum(row))])
    return table(caption, ["Diagnosis", *columns, "All"], listed)


def _heat(count: int, most: int) -> TableCell:
    if not count:
        return TableCell('<span class="quiet">0</span>', "0", number=True)
    return TableCell(str(count), heat=count / most, number=True)


def _alike(book: Gradebook) -> str:
    if not book.records:
        return ""
    found = lookalikes.find(book)
    warning = (
        '<p class="note"><strong>Similarity is not proof.</strong> A small exercise has few good solutions, and pairs '
        "may have been allowed to work together. Compare both programs before you draw a conclusion.</p>"
    )
    several = len(book.exercises) > 1
    return warning + _identical(found, several=several) + _similar(found, several=several) + _unseen(book, found)


def _identical(found: lookalikes.LookAlikes, *, several: bool) -> str:
    if not found.identical:
        return "<p>No two submissions are the same file.</p>"
    rows = [
        [", ".join(person(one) for one in group), amount(len(group)), *_exercise(group[0], several=several)]
        for group in found.identical
    ]
    columns = ["Students", "How many", *(["Exercise"] if several else [])]
    return table("The same file, byte by byte", columns, rows)


def _exercise(record: Record, *, several: bool) -> list[TableCell | str]:
    return [html(record.title or record.entry.exercise)] if several else []


def _similar(found: lookalikes.LookAlikes, *, several: bool) -> str:
    of_what = f"{many(found.compared, 'different program')} compared"
    least = f"{lookalikes.THRESHOLD * 100:.0f}&nbsp;%"
    if not found.pairs:
        return f"<p>No two of the others are alike by {least} or more ({of_what}).</p>"
    rows = [[*_pair(pair), *_exercise(pair.first, several=several)] for pair in found.pairs[:_MOST_PAIRS]]
    columns = ["One", "Other", "Alike", *(["Exercise"] if several else [])]
    caption = f"{many(len(found.pairs), 'pair')} alike by {least} or more, names, values and comments aside ({of_what})"
    first = table(caption, columns, rows[:_PAIRS_AT_ONCE])
    if len(rows) <= _PAIRS_AT_ONCE:
        return first
    rest = table("The other pairs", columns, rows[_PAIRS_AT_ONCE:])
    left = len(found.pairs) - len(rows)
    told = f"<p>{many(left, 'pair')} more, less alike than these, are not listed.</p>" if left else ""
    return f"{first}<details><summary>{many(len(rows) - _PAIRS_AT_ONCE, 'more pair')}</summary>{rest}{told}</details>"


def _pair(pair: lookalikes.Pair) -> list[TableCell | str]:
    sides = [f"{person(one)}<br><code>{shown(one.entry.source)}</code>" for one in (pair.first, pair.second)]
    alike = TableCell(f"{pair.similarity * 100:.0f}&nbsp;%", f"{pair.similarity:.4f}", number=True)
    return [*sides, alike]


def _unseen(book: Gradebook, found: lookalikes.LookAlikes) -> str:
    told = []
    if book.root is None:
        told.append("The submissions are no longer available, so only identical ones could be found.")
    elif found.unread:
        told.append(
            f"{many(found.unread, 'program')} could not be read or had too little code of their own to compare."
        )
    if found.pairs:
        told.append("In each pair, one program stands for all that are identical to it.")
    if found.left_out:
        told.append(f"Not compared, because good answers are all alike: {html(', '.join(found.left_out))}.")
    return f'<p class="quiet">{" ".join(told)}</p>' if told else ""


def _extremes(book: Gradebook) -> str:
    graded = [record for record in book.records if not record.same_as and record.report["duration_s"]]
    slowest = sorted(graded, key=lambda one: -float(one.report["duration_s"]))[:_MOST_LISTED]
    largest = sorted(book.records, key=lambda one: -one.size)[:_MOST_LISTED]
    content = ""
    if slowest:
        rows = [
            [*_who(one), amount(one.report["duration_s"], "&nbsp;s", f"{one.report['duration_s']:.2f}")]
            for one in slowest
        ]
        content += table("Slowest to grade", ["Student", "Exercise", "Time"], rows)
    if largest:
        rows = [[*_who(one), amount(one.size, "&nbsp;kB", f"{one.size / _KB:.1f}")] for one in largest]
        content += table("Largest", ["Student", "Exercise", "Size"], rows)
    return content


def _who(record: Record) -> list[TableCell | str]:
    return [person(record), html(record.title or record.entry.exercise)]


def _failed(book: Gradebook) -> str:
    """Those for whom the grader itself failed."""
    if not book.not_graded:
        return ""
    rows = [[*_who(one), shown(problem(one))] for one in book.not_graded]
    told = (
        "<p>That is the grader's fault, not the students'. Run the same command again with <code>--resume</code>.</p>"
    )
    return told + table("No grade, and in no export", ["Student", "Exercise", "What happened"], rows)


def _dropped(book: Gradebook) -> str:
    rows = [(shown(student), shown(reason)) for student, reason in book.dropped]
    return table("Check what these students handed in", ["Student", "Reason"], rows) if rows else ""


def _odd(book: Gradebook) -> str:
    rows = [(shown(student), shown(reason)) for student, reason in book.odd]
    return table("Graded, each entry as a separate student", ["Student", "Reason"], rows) if rows else ""


def _missing(book: Gradebook) -> str:
    titles = {exercise.id: exercise.title for exercise in book.exercises}
    rows = [(shown(student), html(titles.get(exercise, exercise))) for student, exercise in book.missing]
    return table("Students who handed in only something else", ["Student", "Exercise"], rows) if rows else ""


def _left(book: Gradebook) -> str:
    rows = [(f"<code>{shown(path)}</code>", shown(reason)) for path, reason in book.left]
    return table("Other files in the folder, and why they were not graded", ["File", "Reason"], rows) if rows else ""

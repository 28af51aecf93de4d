"""Pieces of HTML that the class page is built from; whoever uses them escapes what strangers wrote."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_kit.classroom.exports.texts import html, number
from course_kit.classroom.records import STUDENTS, safe_name

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from course_kit.classroom.records import Record


_NUMBER = ' class="number"'


@dataclass(frozen=True)
class TableCell:
    """A table's cell.

    Attributes:
        content: HTML.
        value: what it is sorted by, where the content does not tell; an empty text is sorted to the end.
        heat: from 0 to 1, how strongly it is coloured; None for not at all.
        number: whether it stands to the right, as numbers do.
    """

    content: str
    value: str | None = None
    heat: float | None = None
    number: bool = False


def amount(value: float, unit: str = "", shown: str | None = None) -> TableCell:
    """A number, with its unit beside it."""
    return TableCell(f"{shown or number(value)}{unit}", number(value), number=True)


def table(
    caption: str,
    columns: Sequence[str],
    rows: Iterable[Sequence[TableCell | str]],
    *,
    kind: str = "sortable",
    id_: str = "",
) -> str:
    """A table whose first column names its rows.

    Args:
        caption: HTML; says what the table shows.
        columns: HTML of each column's heading.
        rows: their cells; a text is a cell's HTML.
        kind: the class; what is `sortable` gets a button in each heading where JavaScript runs.
        id_: for links and labels.
    """
    listed = [[cell if isinstance(cell, TableCell) else TableCell(cell) for cell in row] for row in rows]
    right = [cell.number for cell in listed[0]] if listed else [False] * len(columns)
    head = "".join(
        f'<th scope="col"{_NUMBER if number else ""}>{column}</th>'
        for column, number in zip(columns, right, strict=True)
    )
    body = "\n".join(f"<tr>{_row(row)}</tr>" for row in listed)
    name = f' id="{id_}"' if id_ else ""
    return (
        f'<div class="wide" tabindex="0" role="group" aria-label="Table"><table class="{kind}"{name}>'
        f"<caption>{caption}</caption><thead><tr>{head}</tr></thead>\n<tbody>{body}</tbody></table></div>"
    )


def _row(cells: Sequence[TableCell]) -> str:
    return _cell(cells[0], "th") + "".join(_cell(cell, "td") for cell in cells[1:])


def _cell(cell: TableCell, tag: str) -> str:
    attributes = ' scope="row"' if tag == "th" else ""
    attributes += f' data-value="{html(cell.value)}"' if cell.value is not None else ""
    classes = [name for name, wanted in (("number", cell.number), ("heat", cell.heat is not None)) if wanted]
    attributes += f' class="{" ".join(classes)}"' if classes else ""
    attributes += f' style="--heat:{cell.heat * 100:.0f}%"' if cell.heat is not None else ""
    return f"<{tag}{attributes}>{cell.content}</{tag}>"


def section(name: str, title: str, content: str) -> str:
    """A part of the page, for the list of contents to link to."""
    return (
        f'<section id="{name}" aria-labelledby="{name}-title"><h2 id="{name}-title">{title}</h2>\n{content}</section>\n'
    )


def person(record: Record) -> str:
    """A student, by name where there is one, with a link to the report."""
    return f'<a href="{report(record)}">{shown(record.entry.name or record.entry.student)}</a>'


def report(record: Record) -> str:
    """Where a submission's report lies, seen from the class page."""
    return quote(f"{STUDENTS}/{safe_name(record.entry.student)}/{record.entry.exercise}.html")


def shown(text: str) -> str:
    """A stranger's text, which may run from right to left without turning its surroundings."""
    return f"<bdi>{html(text)}</bdi>"


def many(count: int, one: str, more: str = "") -> str:
    """`1 student`, `2 students`."""
    return f"{count} {one if count == 1 else more or one + 's'}"


def share(part: int, whole: int) -> str:
    """A share in per cent; nothing of nothing is 0 %."""
    return f'<span class="share">{100 * part / whole if whole else 0:.0f}&nbsp;%</span>'

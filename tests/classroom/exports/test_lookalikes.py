"""What looks alike, and what only has the same starter or the same idea."""

from __future__ import annotations

import json
import random
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom.exports import lookalikes
from tests.classroom.exports.books import SERVICE, book, good
from tests.classroom.exports.programs import ORIGINAL, OTHER, class_of, disguised, moved, starter

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def names(found: lookalikes.LookAlikes) -> list[tuple[str, str]]:
    return [(pair.first.entry.student, pair.second.entry.student) for pair in found.pairs]


def groups(found: lookalikes.LookAlikes) -> list[list[str]]:
    return [[one[0].first.entry.student, *(pair.second.entry.student for pair in one)] for one in found.groups]


@pytest.mark.parametrize("change", [disguised, moved, lambda text: disguised(moved(text))])
def test_a_changed_copy_looks_alike(tmp_path: Path, change: Callable[[str], str]) -> None:
    found = lookalikes.find_lookalikes(
        book(*class_of(tmp_path, ann=ORIGINAL, bob=OTHER, cid=change(ORIGINAL)), root=tmp_path)
    )
    assert names(found) == [("ann", "cid")]
    assert found.pairs[0].similarity >= lookalikes.THRESHOLD
    assert found.compared == 3


def test_the_starter_makes_nobody_alike(tmp_path: Path) -> None:
    class_ = class_of(tmp_path, ann=starter() + ORIGINAL, bob=starter() + OTHER)
    assert names(lookalikes.find_lookalikes(book(*class_, root=tmp_path))) == []
    class_ = class_of(tmp_path, cid=starter(), dan=starter() + "\n# mine\n")
    found = lookalikes.find_lookalikes(book(*class_, root=tmp_path))
    assert (found.groups, found.compared, found.unread) == ((), 0, 0)
    class_ = class_of(tmp_path, eve=starter(), fay=starter(), gus=ORIGINAL, hal=ORIGINAL)
    found = lookalikes.find_lookalikes(book(*class_, root=tmp_path))
    assert groups(found) == [["gus", "hal"]]
    assert names(found) == []


def test_the_work_of_a_group_is_not_alike(tmp_path: Path) -> None:
    copied = disguised(ORIGINAL)
    class_ = class_of(tmp_path, ann=ORIGINAL, bob=ORIGINAL, cid=copied, dan=f"{copied}\n# mine")
    of_teams = [replace(record, entry=replace(record.entry, platform={"group": "red"})) for record in class_]
    found = lookalikes.find_lookalikes(book(*of_teams, root=tmp_path))
    assert found.groups == ()
    alone = lookalikes.find_lookalikes(book(*class_, root=tmp_path))
    assert groups(alone) == [["ann", "bob", "cid", "dan"]]
    assert len(alone.pairs) == 2


def test_what_many_write_makes_nobody_alike(tmp_path: Path) -> None:
    """Forty with most of their programs in common and a little of their own, and one who has taken another's."""

    def own(number: int) -> str:
        chance = random.Random(number)  # noqa: S311 - an example
        lines = [f"    x = y {chance.choice('+-*/%&|^<>')} z {chance.choice('+-*/%&|^<>')} x" for _ in range(8)]
        return ORIGINAL + OTHER + f"\ndef own{number}(x, y, z):\n" + "\n".join(lines)

    class_ = class_of(tmp_path, **{f"s{number:02}": own(number) for number in range(40)}, thief=disguised(own(11)))
    assert names(lookalikes.find_lookalikes(book(*class_, root=tmp_path))) == [("s11", "thief")]


def test_a_copy_of_a_copy_is_in_the_group_of_the_original() -> None:
    """The last one is less alike to the first than the threshold, and was not written alone either."""
    own = {"ann": range(100), "bob": range(15, 115), "cid": range(30, 130), "dan": range(200, 300)}
    [found] = lookalikes._groups([([good(student)], frozenset(prints)) for student, prints in own.items()])
    assert [(pair.first.entry.student, pair.second.entry.student) for pair in found] == [("ann", "bob"), ("ann", "cid")]
    assert found[0].similarity >= lookalikes.THRESHOLD > found[1].similarity


def test_a_notebook_is_compared_by_its_cells(tmp_path: Path) -> None:
    cell = '{"cell_type": "code", "source": %s}'
    source = json.dumps(f"%%submission {SERVICE.id}\n{ORIGINAL}")
    (tmp_path / "nb.ipynb").write_text(f'{{"cells": [{cell % source}]}}')
    class_ = class_of(tmp_path, ann=disguised(ORIGINAL))
    found = lookalikes.find_lookalikes(book(*class_, good("bob", source="nb.ipynb"), root=tmp_path))
    assert names(found) == [("ann", "bob")]

"""Whom the class page names first, what it says has changed, and what it sets side by side."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from course_kit.classroom import exports
from course_kit.classroom.exports import attention, changes, page
from course_kit.classroom.records import Entry
from tests.classroom.exports.books import ROBOT, SERVICE, bad, book, check, good, not_graded, record, unreadable
from tests.classroom.exports.programs import ORIGINAL, OTHER, class_of, disguised

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.classroom.records import Gradebook


def people(gradebook: Gradebook) -> dict[str, list[str]]:
    found = attention.group_by_attention(gradebook, attention.label_students(gradebook))
    return {group.id: [f"{one.called}: {one.told}" for one in group.people] for group in found}


def test_everybody_who_needs_it_is_named_with_the_reason_and_nobody_else() -> None:
    half = record("half", [check("first"), check("second", "failed")])
    gradebook = book(
        good("fine", why="it is the newest", others=["old.py: older", "starter.py: as it was given out"]),
        bad("zero", late=True, worry="only its name was better than that of b.py"),
        half,
        unreadable("empty"),
        not_graded("ole"),
        missing=(("eve", SERVICE.id), ("eve", ROBOT.id), ("fine", ROBOT.id)),
        dropped=(("zoe", "it is a link"),),
        odd=(("yan", "it does not fit"),),
        absent=(("eve", "Eve Adams"),),
        others=(Entry("eve", "", "", "Eve Adams"),),
        unknown=(("half", "nobody on it is called so"),),
        exercises=(SERVICE, ROBOT),
    )
    assert people(gradebook) == {
        "failed": [f"ole: {SERVICE.title}: the worker was gone"],
        "dropped": ["zoe: it is a link"],
        "doubtful": ["zero: zero/temperature_service.py: only its name was better than that of b.py"],
        "unknown": ["half: nobody on it is called so"],
        "missing": ["Eve Adams: everything", f"fine: {ROBOT.title}"],
        "not-passed-temperature_service": ["empty: unreadable, 0 of 10", "zero: 0 of 10", "half: 5 of 10"],
        "chosen": [
            "fine: fine/temperature_service.py: it is the newest. Not: old.py: older; starter.py: as it was given out"
        ],
        "odd": ["yan: it does not fit"],
        "late": [f"zero: {SERVICE.title}"],
    }
    assert people(book(good("fine"))) == {}


@pytest.mark.parametrize("section", ["checks", "diagnoses"])
def test_a_check_and_a_diagnosis_unfold_to_their_students(section: str) -> None:
    text = page.render_class(book(bad("jane"), good("ann"), bad("li")))
    start = text.index(f'<section id="{section}"')
    part = text[start : text.index("</section>", start)]
    assert re.findall(r"<li><a [^>]*><bdi>(\w+)</bdi></a></li>", part) == ["jane", "li"]
    folded = re.findall(r"<details><summary>(.*?)</summary>", part)
    assert len(folded) == 1
    assert ("The check first" if section == "checks" else "service.no_return") in folded[0]


def test_what_changed_since_the_last_run_is_told_once(tmp_path: Path) -> None:
    before = book(good("same"), bad("better"), good("gone"), not_graded("repaired"))
    now = book(good("same"), good("better", digest="another"), good("repaired"), good("late"))
    exports.write_all(before, tmp_path)
    assert 'id="changes"' not in (tmp_path / "index.html").read_text(), "there was no run before"
    found = {one.student: one for one in changes.since_last_run(now, tmp_path)}
    assert {name: (one.kind, one.before, one.now, one.new_file) for name, one in found.items()} == {
        "better": ("changed", "0, not passed", "10, passed", True),
        "gone": ("gone", "10, passed", "", False),
        "late": ("new", "", "10, passed", False),
        "repaired": ("changed", "grader's error", "10, passed", False),
    }
    page_of_now = exports.write_all(now, tmp_path).read_text()
    assert "10, passed (another file)" in page_of_now
    assert 'id="changes"' not in exports.write_all(now, tmp_path).read_text()


def test_each_pair_has_its_page_and_an_earlier_runs_pages_go(tmp_path: Path) -> None:
    records = class_of(tmp_path / "in", ann=ORIGINAL + "# <b>&", bob=OTHER, cid=disguised(ORIGINAL))
    gradebook = book(*records, root=tmp_path / "in")
    out = tmp_path / "out"
    text = exports.write_all(gradebook, out).read_text()
    assert re.findall(r'href="(lookalikes/[^"]+)"', text) == ["lookalikes/1.html"]
    shown = (out / "lookalikes/1.html").read_text()
    assert "&lt;b&gt;&amp;" in shown
    assert "<script" not in shown
    assert shown.count('<tr class="same">') > 15
    exports.write_all(replace(gradebook, records=gradebook.records[:2]), out)
    assert list((out / "lookalikes").iterdir()) == []

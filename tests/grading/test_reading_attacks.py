"""Files that attack whoever reads them: each costs its own grade, and neither the grader nor anybody else's."""

from __future__ import annotations

import json
import os
import signal
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import psutil
import pytest

from course_kit import grading
from tests.background import started
from tests.grading.conftest import EXERCISE
from tests.waiting import wait_until

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable
    from contextlib import AbstractContextManager
    from pathlib import Path

MB = 1 << 20
MAGIC = f"%%submission {EXERCISE}\n"
SYNTAX, NOTHING = "start.syntax", "start.nothing"


@dataclass(frozen=True)
class Hard:
    """One of them.

    Attributes:
        name: of the file.
        make: its text or its bytes, for a right solution.
        status: of the report, or two.
        said: a part of why there is no grade, or the diagnosis.
        score: the points.
    """

    name: str
    make: Callable[[str], str | bytes]
    status: tuple[str, ...]
    said: str
    score: float = 0.0

    def data(self, solution: str) -> bytes:
        made = self.make(solution)
        return made if isinstance(made, bytes) else made.encode()


def program(text: str, status: str = "crashed", said: str = SYNTAX) -> Hard:
    return Hard("answer.py", lambda _: text, (status,), said)


def notebook(make: Callable[[str], str], status: str, said: str, score: float = 0.0) -> Hard:
    return Hard("answer.ipynb", make, (status,), said, score)


def full(text: str, end: str = "") -> str:
    """A program of 1 MB."""
    return text * ((MB - len(end)) // len(text)) + end


def cells(*sources: str, more: str = "") -> str:
    """A notebook's JSON; `more` is put in as it is."""
    return json.dumps({"cells": [{"cell_type": "code", "source": one} for one in sources]})[:-1] + f"{more}}}"


def nested(opening: str, closing: str = "") -> str:
    return f"x = {opening * 90_000}1{closing * 90_000}\n"


# Before Python 3.12 its parser takes minutes for this one; since then seconds, about as many as it may.
_MANY_FIELDS = f'a = 1\nb = f"{"{a}" * 349_000}"\n'
_TOO_LONG = "more than 5 s of computing"
_NEW_PARSER = sys.version_info >= (3, 12)

PROGRAMS = {
    "blank lines": program(full("\n", "while"), said=SYNTAX),
    "a right program behind blank lines": Hard("answer.py", lambda right: full("\n", right), ("graded",), "", 10.0),
    "nothing but blank lines": program("\n" * MB, "unreadable", "is empty"),
    "an f-string of many fields": (
        Hard("answer.py", lambda _: _MANY_FIELDS, ("unreadable", "crashed"), "")
        if _NEW_PARSER
        else program(_MANY_FIELDS, "unreadable", _TOO_LONG)
    ),
    "parentheses in each other": program(nested("(", ")")),
    "minus before minus": program(nested("-")),
    "lambdas in each other": program(nested("lambda: ")),
    "f-strings in each other": program(
        "x = " + 'f"{' * 60 + "1" + '}"' * 60 + "\n", said=NOTHING if _NEW_PARSER else SYNTAX
    ),
    "a sum of half a million": program(
        full("1+", "1\n"), *(("unreadable", "crashes") if sys.version_info < (3, 11) else ())
    ),
    "more statements than memory": program(full("a;"), "unreadable", "more than 768 MB of memory"),
    "a number of a million digits": program(f"x = {'1' * (MB - 10)}\n"),
    "a line of 1 MB that is no Python": program(f"x = '{'a' * (MB - 10)}\n"),
    "null bytes": program("x = 1\n\0", "unreadable", "null bytes"),
    "one byte too many": program("#" * (MB + 1), "unreadable", "larger than 1024 kB"),
    "not UTF-8": Hard("answer.py", lambda _: b"x = '\xff'\n", ("unreadable",), "not UTF-8"),
    "a name with a line end": Hard(
        "ans\nwer.py", lambda _: "import nothing_of_this_name\n", ("crashed",), "start.import"
    ),
    "a module's name": Hard("csv.py", lambda _: "from csv import reader\n", ("crashed",), "start.crash"),
}
NOTEBOOKS = {
    "outputs of 60 MB": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": "{"a" * (60 * MB)}"'), "graded", "", 10.0
    ),
    "more than 64 MB": notebook(
        lambda right: cells(MAGIC + right) + " " * (64 * MB), "unreadable", "larger than 64 MB"
    ),
    "lists in each other": notebook(
        lambda _: '{"cells": ' + "[" * 100_000 + "]" * 100_000 + "}", "unreadable", "not a Jupyter"
    ),
    "numbers of a million digits": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": [{"1" * 1_000_000}, 1.{"1" * 1_000_000}]'), "graded", "", 10.0
    ),
    "keys that come twice": notebook(lambda right: '{"cells": [], ' + cells(MAGIC + right)[1:], "graded", "", 10.0),
    "a million empty cells": notebook(
        lambda right: cells(MAGIC + right)[:-2] + ', {"cell_type": "raw"}' * 1_000_000 + "]}", "graded", "", 10.0
    ),
    # Each cell has a place in the answer, and JSON writes each of these characters in six: more than it may have.
    "more parts than an answer holds": notebook(
        lambda _: cells(f"{MAGIC}#{chr(1) * 700_000}", *[MAGIC] * 300_000), "unreadable", "too many parts"
    ),
    "cells that are a text": notebook(lambda _: '{"cells": "abc"}', "unreadable", "not a Jupyter"),
    "cells that are none": notebook(lambda _: '{"cells": [null, 1, []]}', "unreadable", "not a Jupyter"),
    "more objects than memory": notebook(
        lambda right: cells(MAGIC + right, more=f', "x": [{"{}," * (20 * MB)}0]'), "unreadable", "768 MB of memory"
    ),
    "half of a character": notebook(
        lambda _: cells(MAGIC + "x = '\ud800'"), "unreadable", "half of a character (U+D800)"
    ),
    "more than 1 MB of code": notebook(lambda _: cells(MAGIC + "#" * MB), "unreadable", "more than 1024 kB of code"),
    "a million lines": notebook(lambda _: cells(MAGIC + "\n" * (MB - 5) + "1/0"), "crashed", "start.crash"),
}
FILES = {**PROGRAMS, **NOTEBOOKS}


PATIENCE_S = 200.0  # against hanging only
pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]


@pytest.mark.parametrize("what", FILES)
def test_a_file_that_is_hard_to_read_gets_its_report(
    what: str, grade_source: Callable[..., grading.Report], solution: str, tmp_path: Path
) -> None:
    hard = FILES[what]
    report = grade_source(hard.data(solution), hard.name)
    (tmp_path / hard.name).unlink()  # of those tests that pytest keeps nobody wants 64 MB
    told = report.problem or str(report.checks[0].diagnosis)
    assert report.status in hard.status, told
    assert report.score == hard.score
    assert hard.said in told
    assert len(report.to_json()) < 100_000
    assert all(len(line) < 2000 for line in grading.render_text(report).splitlines())


def class_run(folder: Path) -> AbstractContextManager[subprocess.Popen[str]]:
    out = folder.parent / "out"
    return started("-m", "course_kit", "class", folder, "--exercise", EXERCISE, "--out", out, "--layout", "folders")


def hand_in(folder: Path, student: str, name: str, data: bytes) -> None:
    (folder / student).mkdir(parents=True)
    (folder / student / name).write_bytes(data)


def test_the_rest_of_a_class_is_graded(tmp_path: Path, solution: str) -> None:
    """All of them at once, each a student's, beside one that is right."""
    students = {f"s{place:02}": hard for place, hard in enumerate(FILES.values())}
    for student, hard in students.items():
        hand_in(tmp_path / "in", student, hard.name, hard.data(solution))
    hand_in(tmp_path / "in", "zoe", f"{EXERCISE}.py", solution.encode())
    with class_run(tmp_path / "in") as process:
        said, _ = process.communicate(timeout=PATIENCE_S)
    for path in (tmp_path / "in").glob("*/*.ipynb"):
        path.unlink()
    assert process.returncode == 0, said
    assert "Traceback" not in said
    records = {path.parent.name: path for path in (tmp_path / "out/students").glob("*/*.json")}
    reports = {name: json.loads(path.read_text())["report"] for name, path in records.items()}
    assert set(reports) == {*students, "zoe"}
    for student, hard in students.items():
        assert reports[student]["status"] in hard.status, (hard.name, reports[student])
        assert reports[student]["score"] == hard.score
    assert (reports["zoe"]["status"], reports["zoe"]["score"]) == ("graded", 10.0)
    assert all(path.stat().st_size < 200_000 for path in (tmp_path / "out").rglob("*.*"))


def test_ctrl_c_ends_a_class_while_it_is_read(tmp_path: Path) -> None:
    """Reading one of these takes seconds, all of them minutes."""
    for number in range(60):
        text = f"a = {number}\nb = f'" + "{a}" * 349_000 + "'\n"
        hand_in(tmp_path / "in", f"s{number}", f"{EXERCISE}.py", text.encode())
    with class_run(tmp_path / "in") as process:
        wait_until(lambda: is_reading(process.pid), "the first submission being read")
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, said
    assert "Traceback" not in said
    assert "Nothing was graded; run the same command again." in said
    assert list((tmp_path / "out/students").glob("*/*.json")) == []


def is_reading(process: int) -> bool:
    """Whether the reader of a class run is at work on a submission: it has a child."""
    try:
        readers = [one for one in psutil.Process(process).children() if "course_kit.reader" in " ".join(one.cmdline())]
        return any(one.children() for one in readers)
    except psutil.NoSuchProcess:
        return False


def test_a_notebook_is_found_by_a_cell_behind_large_outputs(tmp_path: Path, solution: str) -> None:
    """Its name tells nothing, and there is another program beside it."""
    outputs = {"cell_type": "code", "source": "1", "outputs": ["a" * 5_000_000]}
    cell = {"cell_type": "code", "source": f"%%submission {EXERCISE}\n{solution}"}
    hand_in(tmp_path / "in", "ann", "work.ipynb", json.dumps({"cells": [outputs, cell]}).encode())
    (tmp_path / "in/ann/notes.py").write_text(full("\n"))
    with class_run(tmp_path / "in") as process:
        said, _ = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, said
    record = json.loads((tmp_path / f"out/students/ann/{EXERCISE}.json").read_text())
    assert (record["entry"]["source"], record["report"]["score"]) == ("ann/work.ipynb", 10.0)

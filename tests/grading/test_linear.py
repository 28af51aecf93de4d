"""Nothing that looks at a stranger's text takes the square of its length: neither a pattern nor a function.

The patterns are found in the modules themselves, with the methods they are used by; so a new one is measured as well.
"""

from __future__ import annotations

import ast
import importlib
import io
import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import course_kit
from course_kit.graders import _limiter
from course_kit.grading import engine
from course_kit.grading.checks import evidence
from course_kit.grading.diagnosis import causes, tracebacks
from course_kit.grading.model.job import Job
from course_kit.grading.model.submission import Submission
from course_kit.reader import fingerprints, process, python
from course_kit.text.sanitize import make_printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

ROOT = Path(course_kit.__file__).parent
PACKAGES = ("grading", "graders", "reader", "quiz", "classroom", "text", "integrations")
METHODS = {"match", "fullmatch", "search", "findall", "finditer", "sub", "split"}
# Runs of each of these, and of each with what a pattern itself is made of before and behind.
UNITS = (*" \n\ta0_.:-/'\"\\#=\0ä", '\\"', " :", "a\n", "0a")
MISFIT = "\n\0!"  # after which a pattern that wants the whole text tries all it has taken again
SIZE = 2_000  # characters; of many more a cubic pattern would take hours
LONGER = 4  # times as long is the second text; twice could be one step in the processor's caches, of the factor 3
MOST = 9.0  # times as long does it take: a square would be 16
RUNS = 3  # the fastest counts, where one run has shown something


def modules() -> Iterator[Path]:
    for package in PACKAGES:
        yield from sorted((ROOT / package).rglob("*.py"))


def patterns() -> Iterator[tuple[str, str, str]]:
    """Module, name and method of each use of a compiled pattern."""
    for path in modules():
        text = path.read_text()
        if "re.compile(" not in text:
            continue
        tree = ast.parse(text)
        names = {
            target.id
            for node in tree.body
            if isinstance(node, ast.Assign) and ast.unparse(node.value).startswith("re.compile(")
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        uses = {
            (node.value.id, node.attr)
            for node in ast.walk(tree)
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in names
        }
        module = ".".join(path.relative_to(ROOT.parent).with_suffix("").parts)
        for name in sorted(names):
            used = sorted(method for one, method in uses if one == name and method in METHODS)
            assert used, f"{module}.{name} is not used where it is made: name here how it is"
            yield from ((module, name, method) for method in used)


def inputs(pattern: str) -> Iterator[Callable[[int], str]]:
    """Texts of any length that a pattern may find hard."""
    bare = re.sub(r"#.*|\\[a-zA-Z]|\(\?P<\w+>|\[[^]]*\]|[{}()|+*?^$]", "\n", pattern)
    pieces = ["", *dict.fromkeys(piece.strip("\n") for piece in re.findall(r"[^\n]*\w\w[^\n]*|['\"]+", bare))]
    for piece in pieces:
        for unit in UNITS:
            yield lambda n, piece=piece, unit=unit: piece + unit * (n // len(unit))  # type: ignore[misc]
            yield lambda n, piece=piece, unit=unit: piece + unit * (n // len(unit)) + MISFIT  # type: ignore[misc]
            if piece:
                yield lambda n, piece=piece, unit=unit: (piece + unit) * (n // len(piece + unit))  # type: ignore[misc]
                yield lambda n, piece=piece, unit=unit: unit * (n // len(unit)) + piece  # type: ignore[misc]


def fastest(work: Callable[[Any], object], argument: Any, runs: int) -> float:
    """Seconds of computing: what the machine does beside is not counted."""
    times = []
    for _ in range(runs):
        began = time.thread_time()
        work(argument)
        times.append(time.thread_time() - began)
    return min(times)


def grows(work: Callable[[Any], object], make: Callable[[int], Any]) -> bool:
    """Whether a text that is longer takes far more time than its length tells."""
    short, long = make(SIZE), make(LONGER * SIZE)
    return all(fastest(work, long, runs) > MOST * fastest(work, short, runs) for runs in (1, RUNS, RUNS))


@pytest.mark.parametrize(("module", "name", "method"), list(patterns()))
def test_no_pattern_takes_the_square_of_a_texts_length(module: str, name: str, method: str) -> None:
    pattern = getattr(importlib.import_module(module), name)
    is_bytes = isinstance(pattern.pattern, bytes)
    source = pattern.pattern.decode() if is_bytes else pattern.pattern
    use = getattr(pattern, method)

    def work(given: Any) -> object:
        if method == "sub":
            return use(b"" if is_bytes else "", given)
        found = use(given)
        return sum(1 for _ in found) if method == "finditer" else found

    for make in inputs(source):
        made = (lambda n, make=make: make(n).encode()) if is_bytes else make  # type: ignore[misc]
        assert not grows(work, made), f"{module}.{name}.{method} on {make(60)!r}"


def test_every_pattern_has_a_name_and_so_is_measured() -> None:
    """But one, which is made of an exercise's own words: it is measured as a part of `process.look_at`."""
    found = []
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text())):
            call = ast.unparse(node.func) if isinstance(node, ast.Call) else ""
            if call.startswith("re.") and call not in ("re.compile", "re.escape"):
                found.append(f"{path.name}: {call}")
    assert found == ["process.py: re.search"]


JOB = Job("course_kit.graders.temperature_service", "run", 1, Submission("answer.py", "answer.py", "x = 1\n"))
COMMON = {"class_name": "", "variable": "", "whatever": False, "compared": True, "files": []}
VARIABLE = {**COMMON, "exercise": "pattern_choice", "variable": "answers"}
CLASS = {**COMMON, "exercise": "temperature_service", "class_name": "TemperatureService"}
FRAME = '  File "answer.py", line 3, in f\n'
DUMP = "Current thread 0x1 (most recent call first):\n"
FUNCTIONS: dict[str, Callable[[str], object]] = {
    "status": _limiter.read_status,
    "reason": lambda given: _limiter.missing_in_reason("max_velocity", 7.2, "max_velocity " + given),
    "exception": lambda given: tracebacks.last_exception(
        "Traceback (most recent call last):\n" + given, ("answer.py",)
    ),
    "activity": lambda given: tracebacks.read_activity(DUMP + given, ("answer.py",)),
    "logged": lambda given: causes.explain_logged_exception(
        "Traceback (most recent call last):\nImportError: " + given, JOB
    ),
    "source line": lambda given: causes.source_line(Job("", "run", 1, Submission("a.py", "a.py", given)), 1),
    "printable": make_printable,
    "cut": engine.cut_text,
    "step": evidence._cut,
    "class in a program": lambda given: process.look_at("a.py", io.BytesIO(given.encode()), CLASS),
    "variable in a program": lambda given: process.look_at("a.py", io.BytesIO(given.encode()), VARIABLE),
    "cell in a notebook": lambda given: process.look_at("a.ipynb", io.BytesIO(given.encode()), CLASS),
    "fingerprints": fingerprints.take_fingerprints,
}
MORE = (
    "class TemperatureService",
    "answers",
    "%%submission ",
    "a: 1 m/s ",
    "Traceback (most recent call last):\n",
    FRAME,
    DUMP,
)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_no_function_takes_the_square_of_a_texts_length(function: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(python, "MEMORY_MB", 1 << 20)  # the process of the tests may be large already
    for unit in (*UNITS, *MORE):
        make = lambda n, unit=unit: unit * (n // len(unit))  # noqa: E731 - as those above
        assert not grows(FUNCTIONS[function], make), f"{function} on {make(60)!r}"

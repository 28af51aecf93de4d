"""What scores more than a starter makes the release fail, wherever it hides; and what cannot score is let alone."""

from __future__ import annotations

import json
import re
import textwrap
from typing import TYPE_CHECKING

import nbformat
import pytest

from course_kit.authoring import edition_programs
from course_kit.authoring.edition_programs import ExerciseClues
from course_kit.grading import exercise
from tests.authoring.conftest import git
from tests.course_copy import REPOSITORY, TEMPERATURE

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from tests.course_copy import Course

pytestmark = [pytest.mark.answers, pytest.mark.timeout(300)]

VARIANTS = REPOSITORY / "tests/grading/correct"
CHOICE = "pattern_choice"


def variant(name: str, exercise_id: str = TEMPERATURE) -> str:
    return (VARIANTS / exercise_id / f"{name}.py").read_text()


def cell_with_output(text: str) -> nbformat.NotebookNode:
    output = nbformat.v4.new_output("stream", name="stdout", text=text)
    cell = nbformat.v4.new_code_cell("!cat mine.py", outputs=[output], execution_count=1)
    return nbformat.v4.new_notebook(cells=[cell])


def hide_in_a_test(course: Course) -> str:
    name = "tests/lab/test_hidden.py"
    text = textwrap.indent(variant("class_only").replace('"""', "'''"), "    ")
    write(course, name, f'import textwrap\n\n\ndef test_it():\n    source = """\n{text}"""\n    assert source\n')
    return name


def hide_in_an_output(course: Course) -> str:
    name = "notebooks/07_hidden.ipynb"
    write(course, name, nbformat.writes(cell_with_output("$ cat mine.py\n" + variant("main_guarded"))))
    return name


def hide_in_markdown(course: Course) -> str:
    name = "notebooks/NOTES.md"
    write(course, name, f"# How I did it\n\nSo:\n\n```python\n{variant('own_context')}```\n\nEasy.\n")
    return name


def write(course: Course, name: str, text: str) -> None:
    path = course.root / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.mark.parametrize("hide", [hide_in_a_test, hide_in_an_output, hide_in_markdown])
def test_a_near_solution_makes_the_release_fail(
    one_exercise: Callable[[str], Course], hide: Callable[[Course], str], tmp_path: Path
) -> None:
    course = one_exercise(TEMPERATURE)
    name = hide(course)
    git(course.root, "add", name)
    target = tmp_path / "out" / "student"
    done = course.run("release", str(target))
    assert done.returncode == 1, done.stdout + done.stderr
    row = next(line for line in done.stderr.splitlines() if line.startswith(name))
    assert re.search(rf"{TEMPERATURE} +(9\.5|10) of 10 +1$", row), row
    assert list(target.parent.iterdir()) == []


@pytest.mark.parametrize("file", [f"{TEMPERATURE}.py", f"{TEMPERATURE}.ipynb"])
def test_a_solution_that_was_committed_as_the_starter_is_found(
    one_exercise: Callable[[str], Course], file: str, tmp_path: Path
) -> None:
    course = one_exercise(TEMPERATURE)
    answer = variant("class_only")
    if file.endswith(".ipynb"):
        cell = nbformat.v4.new_code_cell(f"%%submission {TEMPERATURE}\n{answer}")
        answer = nbformat.writes(nbformat.v4.new_notebook(cells=[cell]))
    (course.root / f"exercises/{TEMPERATURE}/{file}").write_text(answer)
    git(course.root, "commit", "-qam", "Lecture 3")
    done = course.run("release", str(tmp_path / "student.zip"))
    assert done.returncode == 1, done.stdout
    assert f"exercises/{TEMPERATURE}/{file}  the starter" in done.stderr
    assert not (tmp_path / "student.zip").exists()


def wanted(exercise_id: str) -> ExerciseClues:
    task = exercise.load(exercise_id)
    pristine = task.folder / task.starter
    solution = REPOSITORY / "solutions" / exercise_id / f"{exercise_id}.py"
    return ExerciseClues(task, pristine.read_text(), solution.read_text())


def found(folder: Path, exercise_id: str = TEMPERATURE) -> list[edition_programs.EditionProgram]:
    return edition_programs.find(folder, [wanted(exercise_id)])


PROGRAM = variant("class_only") if VARIANTS.is_dir() else ""
METHOD = """
def convert(self, request, response):
    response.success = True
    return response
"""
RIGHT = '{"save_map": ("service", "a"), "laser_scan": ("topic", "b"), "dock_to_charge": ("action", "c")}'


@pytest.mark.parametrize(
    ("name", "text", "place"),
    [
        ("a.py", PROGRAM, "line 1"),
        ("a.txt", PROGRAM, "line 1"),
        ("a.py", f"x = 1\ny = {PROGRAM!r}\n", "line 2"),
        ("a.py", f"y = {PROGRAM.encode()!r}\n", "line 1"),
        ("a.py", f"y = f'''{PROGRAM.replace('{', '{{').replace('}', '}}')}'''\n", "line 1"),
        ("a.py", f"y = {PROGRAM.splitlines()!r}\n", "line 1"),
        (
            "a.py",
            f"def f():\n    r'''Like this:\n\n    ```\n{textwrap.indent(PROGRAM, '    ')}    ```\n    '''\n",
            "line 5",
        ),
        ("a.md", f"So:\n\n~~~python\n{PROGRAM}~~~\n", "line 4"),
        ("a.md", f"So:\n\n{textwrap.indent(PROGRAM, '    ')}\nThat is all of it.\n", "line 3"),
        ("a.md", f"So:\n\n{textwrap.indent(PROGRAM, '>>> ')}\n", "line 3"),
        ("a.toml", f"[a]\nb = 1\nc = '''\n{PROGRAM.replace(chr(39), chr(34))}'''\n", "line 3"),
        ("a.toml", f"c = {json.dumps(PROGRAM)}\n", "line 1"),
        ("a.json", json.dumps({"deep": [{"text": PROGRAM}]}), "line 1"),
        ("a.html", f"<pre>{PROGRAM.replace('<', '&lt;').replace('class ', '<b>class</b> ')}</pre>", "line 1"),
        ("a.ipynb", nbformat.writes(cell_with_output(f"\x1b[32m{PROGRAM}\x1b[0m")), "cell 1, output"),
    ],
)
def test_a_program_is_found(tmp_path: Path, name: str, text: str, place: str) -> None:
    (tmp_path / name).write_text(text)
    programs = found(tmp_path)
    assert [one.file for one in programs] == [name]
    assert programs[0].place == place
    compile(programs[0].source, name, "exec")
    assert 'create_service(ConvertTemperature, "convert_temperature", fill)' in programs[0].source
    assert "from rclpy.node import Node" in programs[0].source


def test_of_a_notebook_each_cell_the_marked_and_all_cells_are_looked_at(tmp_path: Path) -> None:
    head, rest = PROGRAM.split("class TemperatureService")
    sources = [f"%%submission {TEMPERATURE}\n{head}", "%load_ext course_kit\nx = 1", f"class TemperatureService{rest}"]
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "a.ipynb")
    (whole,) = [one for one in found(tmp_path) if one.place == "all code cells"]
    assert head.strip() in whole.source
    assert rest.strip() in whole.source
    cells[2].source = f"%%submission {TEMPERATURE}\n{sources[2]}"
    nbformat.write(nbformat.v4.new_notebook(cells=cells), tmp_path / "a.ipynb")
    (marked,) = [one for one in found(tmp_path) if one.place.startswith("the cells marked")]
    assert head.strip() in marked.source
    assert "x = 1" not in marked.source


def test_a_method_alone_is_put_into_the_starter(tmp_path: Path) -> None:
    (tmp_path / "a.md").write_text(f"In short:\n```python\n{METHOD}```\n")
    (one,) = found(tmp_path)
    compile(one.source, "a", "exec")
    assert "        response.success = True\n" in one.source
    assert "Your code goes here" not in one.source
    assert "rclpy.spin(node)" in one.source


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.py", f"answers = {RIGHT}\n"),
        ("a.py", f"RIGHT = {RIGHT}\n"),
        ("a.md", f"```\n{RIGHT}\n```\n"),
        ("a.toml", 'save_map = ["service", "a"]\nlaser_scan = ["topic", "b"]\ndock_to_charge = ["action", "c"]\n'),
        ("a.json", json.dumps({"x": [{name: list(pair) for name, pair in eval(RIGHT).items()}]})),  # noqa: S307 - ours
    ],
)
def test_answers_are_found_under_any_name(tmp_path: Path, name: str, text: str) -> None:
    (tmp_path / name).write_text(text)
    sources = [one.source for one in found(tmp_path, CHOICE)]
    assert sources
    for source in sources:
        names: dict[str, object] = {}
        exec(source, names)  # noqa: S102 - ours
        assert names["answers"]["laser_scan"] == ("topic", "b")  # type: ignore[index]


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("a.png", b"\x89PNG\0class TemperatureService"),
        ("a.py", b"print('/convert_temperature')\n"),
        ("a.md", b"The class TemperatureService offers /convert_temperature.\n"),
        ("a.ipynb", b"not a notebook of class TemperatureService"),
        ("a.toml", b"[broken\nTemperatureService"),
        ("a.py", b'"""A TemperatureService.\n\nimport rclpy\n"""\n'),
    ],
)
def test_what_is_no_program_for_it_is_let_alone(tmp_path: Path, name: str, data: bytes) -> None:
    (tmp_path / name).write_bytes(data)
    assert found(tmp_path) == []

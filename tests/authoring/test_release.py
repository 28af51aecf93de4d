"""The student edition of this course: what is in it, what is not, and that it works by itself."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import nbformat
import pytest

from course_kit import environment
from course_kit.authoring import edition_plan, release
from course_kit.cli import main as cli
from course_kit.grading.errors import GradingError
from tests.course_copy import TEMPERATURE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from tests.course_copy import Course

REPOSITORY = Path(__file__).resolve().parent.parent.parent
HELPER = "course_kit/interfaces/native/_helper.so"  # built by the set-up, in the student edition as here
INSTRUCTORS_VERBS = ("class", "dev", "export", "otter", "present", "release", "seeds")
_LINK = re.compile(r"\]\((?!https?:|mailto:|#|attachment:)([^)#?\s]+)")

pytestmark = [pytest.mark.answers, pytest.mark.timeout(400)]


class Edition(NamedTuple):
    """An edition of this course."""

    root: Path
    planned: edition_plan.EditionPlan


@pytest.fixture(scope="module")
def edition(tmp_path_factory: pytest.TempPathFactory) -> Edition:
    """Made without the proof that no program in it scores, which takes a minute."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(release.leaks, "_find_scoring", lambda *_: ())
        made = Edition(*release.make_edition(tmp_path_factory.mktemp("release") / "student edition"))
    shutil.copy2(REPOSITORY / HELPER, made.root / HELPER)
    return made


@pytest.fixture(scope="module")
def student(edition: Edition) -> Path:
    return edition.root


def run(student: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=student,
        env=environment.child_environment(PYTHONPATH=str(student)),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


def test_it_has_the_course_and_none_of_the_answers(student: Path) -> None:
    for name in ("course", "pyproject.toml", "README.md", "notebooks/01_services.ipynb", "tests/conftest.py"):
        assert (student / name).is_file(), name
    assert os.access(student / "course", os.X_OK)
    for name in (
        "solutions",
        "tests/broken",
        "tests/slips",
        "tests/grading",
        "course_kit/authoring",
        ".ci",
        "benchmarks",
    ):
        assert not (student / name).exists(), name
    answers = {path.read_bytes() for path in REPOSITORY.glob("solutions/*/*.*")}
    assert answers
    assert not [path for path in student.rglob("*") if path.is_file() and path.read_bytes() in answers]
    for path in student.glob("notebooks/**/*.ipynb"):
        assert not edition_plan.has_answers(nbformat.read(path, as_version=4)), path


def test_no_program_in_it_scores(edition: Edition) -> None:
    assert release.leaks.find_leaks(edition.root, edition.planned.solutions) == []


def test_every_module_of_it_can_be_imported(student: Path) -> None:
    modules = [".".join(path.relative_to(student).with_suffix("").parts) for path in student.glob("course_kit/**/*.py")]
    modules = [name.removesuffix(".__init__") for name in modules if not name.endswith("__main__")]
    assert len(modules) > 200
    code = f"import importlib\nfor name in {modules!r}: importlib.import_module(name)"
    done = run(student, "-c", code)
    assert done.returncode == 0, done.stderr


def test_it_offers_no_command_of_the_instructors(student: Path) -> None:
    assert set(INSTRUCTORS_VERBS) < _verbs(cli.build_parser().format_help())
    offered = _verbs(run(student, "-m", "course_kit", "--help").stdout)
    assert {"lab", "grade", "doctor"} < offered
    assert not offered & set(INSTRUCTORS_VERBS)
    for root in (REPOSITORY, student):  # before the set-up a learner reads it; the others have --help
        usage = subprocess.run([root / "course", "help"], capture_output=True, text=True, timeout=60, check=True).stdout
        assert "grade EXERCISE  " in usage
        assert not re.findall(rf"^  (?:{'|'.join(INSTRUCTORS_VERBS)})\b", usage, re.MULTILINE)
    texts = [(student / "README.md").read_text(), *(path.read_text() for path in student.glob("notebooks/**/*.ipynb"))]
    for verb in INSTRUCTORS_VERBS:
        assert not [text for text in texts if f"./course {verb}" in text], verb


def _verbs(help_text: str) -> set[str]:
    return set(re.findall(r"^    (\w+)", help_text, re.MULTILINE))


def test_its_readme_is_for_students_and_what_it_names_is_there(student: Path) -> None:
    text = (student / "README.md").read_text()
    assert text != (REPOSITORY / "README.md").read_text()
    assert {"./course lab", "./course grade", "./course doctor"} <= set(re.findall(r"\./course \w+", text))
    offered = _verbs(run(student, "-m", "course_kit", "--help").stdout) | {"test"}
    assert set(re.findall(r"\./course (\w+)", text)) <= offered
    paths = set(re.findall(r"(?:exercises|notebooks|course_kit)/[\w./]*", text))
    assert paths
    assert [name for name in paths if not (student / name).exists()] == []


def test_it_has_the_guides_that_students_need_and_their_links_lead_somewhere(student: Path) -> None:
    guides = {path.name: path for path in student.glob("course_kit/guides/*")}
    assert guides.keys() == {"exercises.md", "own_programs.md"}
    for path in (student / "README.md", *guides.values()):
        links = [link for link in _links(path.read_text()) if "://" not in link]
        assert [link for link in links if not (path.parent / link).exists()] == [], path


def test_its_notebooks_are_whole_and_no_link_leads_to_a_file_that_is_not_there(student: Path) -> None:
    notebooks = [*student.glob("notebooks/**/*.ipynb"), *student.glob("exercises/**/*.ipynb")]
    assert len(notebooks) > 10
    for path in notebooks:
        notebook = nbformat.read(path, as_version=4)
        nbformat.validate(notebook)
        text = "\n".join(cell.source for cell in notebook.cells if cell.cell_type == "markdown")
        assert [link for link in _links(text) if not (path.parent / link).exists()] == [], path
    for path in student.rglob("*.md"):
        assert [link for link in _links(path.read_text()) if not (path.parent / link).exists()] == [], path


def _links(text: str) -> Iterator[str]:
    code_left_out = re.sub(r"`{3,}.*?`{3,}|`[^`\n]*`", "", text, flags=re.DOTALL)
    yield from _LINK.findall(code_left_out)


def test_its_own_tests_are_found_and_those_of_the_notebooks_pass(student: Path) -> None:
    found = run(student, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider")
    assert found.returncode == 0, found.stdout[-3000:]
    passed = run(student, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests/notebooks/test_form.py", "tests/robot")
    assert passed.returncode == 0, passed.stdout[-3000:]
    assert "test_form" in found.stdout
    assert "test_release" not in found.stdout


def test_a_learner_is_graded_in_it(student: Path) -> None:
    starter = "exercises/temperature_service/temperature_service.py"
    graded = run(student, "-m", "course_kit", "grade", "temperature_service", starter, "--format", "json")
    assert json.loads(graded.stdout)["status"] == "graded", graded.stderr
    assert graded.returncode == 1


def test_a_zip_holds_the_same_and_keeps_the_door_executable(student: Path, tmp_path: Path) -> None:
    release.pack_edition(student, tmp_path / "student.zip")
    with zipfile.ZipFile(tmp_path / "student.zip") as packed:
        names = {name.removeprefix(f"{release.NAME}/") for name in packed.namelist()}
        assert packed.getinfo(f"{release.NAME}/course").external_attr >> 16 & 0o111
    assert names >= edition_plan.plan_edition(REPOSITORY).files.keys()


def test_the_command_writes_a_zip_and_a_list_of_all_that_stayed_out(
    one_exercise: Callable[[str], Course], tmp_path: Path
) -> None:
    clone = one_exercise(TEMPERATURE)
    (clone.root / "exam").mkdir()
    (clone.root / "exam" / "question.md").touch()
    listed = tmp_path / "left out.txt"
    done = clone.run("release", str(tmp_path / "student.ZIP"), "--left-out", str(listed))
    assert done.returncode == 0, done.stderr
    assert f"1 exercise: {TEMPERATURE}." in done.stdout
    assert zipfile.is_zipfile(tmp_path / "student.ZIP")
    names = listed.read_text().splitlines()
    assert names == sorted(names)
    assert {"exam/question.md", "course_kit/authoring/release.py"} < set(names)


def test_an_archive_of_another_kind_is_refused(tmp_path: Path) -> None:
    with pytest.raises(GradingError, match=r"Name a folder, or a file that ends in \.zip"):
        release.make_edition(tmp_path / "new" / "student.tar")
    assert not list(tmp_path.iterdir())


def test_cells_tagged_answer_are_left_out_and_the_others_numbered_anew() -> None:
    cell = nbformat.v4.new_code_cell
    result = nbformat.v4.new_output("execute_result", {"text/plain": "3"}, execution_count=3)
    notebook = nbformat.v4.new_notebook(
        cells=[
            cell("broken()", execution_count=1),
            cell("repaired()", execution_count=2, metadata={"tags": ["answer"]}),
            nbformat.v4.new_markdown_cell("Show this with ./course present", metadata={"tags": ["instructor"]}),
            cell("later()"),
            cell("1 + 2", execution_count=3, outputs=[result]),
        ]
    )
    kept = edition_plan.remove_answers(notebook).cells
    assert [one.source for one in kept] == ["broken()", "later()", "1 + 2"]
    assert [one.execution_count for one in kept] == [1, None, 2]
    assert kept[2].outputs[0].execution_count == 2

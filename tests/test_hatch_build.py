"""The build hook: which compiler it takes, and when it asks for one."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hatchling.builders.sdist import SdistBuilder
from hatchling.builders.wheel import WheelBuilder

import hatch_build
from course_kit.interfaces.native.loader import load_helper
from course_kit.learner import workspace

if TYPE_CHECKING:
    from collections.abc import Callable

REPOSITORY = Path(__file__).resolve().parent.parent
HELPER = REPOSITORY / hatch_build.LIBRARY  # built by the set-up

WITHOUT_HEADERS = """#!/bin/sh
echo 'helper.c:14:10: fatal error: stdbool.h: No such file or directory' >&2
exit 1
"""
# Stands in for a compiler: whatever it is asked for, it hands out the same library.
HANDS_OUT = """#!/bin/sh
while [ "$1" != -o ]; do shift; done
cp '{library}' "$2"
"""


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """A folder with the C files, and nothing else of the course."""
    folder = tmp_path / "a course"
    (folder / hatch_build.SOURCE).parent.mkdir(parents=True)
    for source in (hatch_build.SOURCE, hatch_build.LEAVING):
        shutil.copy(REPOSITORY / source, folder / source)
    return folder


@pytest.fixture
def compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str, str], None]:
    """Put a stand-in for a compiler on PATH, where no other is."""
    tools = tmp_path / "tools"
    tools.mkdir()
    for name in ("cp", "sh"):
        (tools / name).symlink_to(str(shutil.which(name)))
    monkeypatch.setenv("PATH", str(tools))
    monkeypatch.delenv("CC", raising=False)

    def put(name: str, text: str) -> None:
        (tools / name).write_text(text)
        (tools / name).chmod(0o755)

    return put


def packages_needed(root: Path) -> list[str]:
    return hatch_build.CustomBuildHook(str(root), {}, None, None, "", "wheel").dependencies()


def test_without_a_compiler_it_asks_for_one(root: Path, compiler: Callable[[str, str], None]) -> None:
    del compiler
    assert packages_needed(root) == ["ziglang>=0.13"]


def test_the_first_compiler_that_works_is_taken_and_leaves_nothing_but_the_library(
    root: Path, compiler: Callable[[str, str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler -v")
    compiler("cc", WITHOUT_HEADERS)
    compiler("clang", HANDS_OUT.format(library=HELPER))
    assert packages_needed(root) == []
    hatch_build.compile_helper(root, hatch_build.system_compilers())
    made = root / hatch_build.LIBRARY
    assert sorted(path.name for path in made.parent.iterdir()) == [made.name, "helper.c", "leaving.c"]
    load_helper(made)


def test_a_source_distribution_holds_the_tests_and_nothing_of_a_learners(tmp_path: Path) -> None:
    for name in ("pyproject.toml", "hatch_build.py", ".gitignore", "tests/test_layers.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(REPOSITORY / name, tmp_path / name)
    (tmp_path / "my-course").mkdir()
    (tmp_path / "my-course" / "mine.py").touch()
    (tmp_path / "my-course" / ".gitignore").write_text("*\n")
    packed = {file.distribution_path for file in SdistBuilder(str(tmp_path)).recurse_included_files()}
    assert packed == {"pyproject.toml", "hatch_build.py", ".gitignore", "tests/test_layers.py"}


def test_a_wheel_hands_out_what_a_clone_does() -> None:
    packed = hatch_build.lessons_and_exercises(REPOSITORY).values()
    given = {path.relative_to(REPOSITORY) for path in workspace._files(REPOSITORY)}
    assert {Path(one).relative_to(hatch_build.COURSE) for one in packed} == given


def test_a_wheel_made_in_a_clone_holds_nothing_that_merely_lies_there(tmp_path: Path) -> None:
    root = tmp_path / "clone"
    own = {"notebooks/one.ipynb", "exercises/task/task.py"}
    strays = {"exercises/task/my_answer.py", "exercises/task/results/grades.csv", "notebooks/.virtual/one.py"}
    for name in own | strays:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).touch()
    for words in (["init", "-q"], ["add", *own]):
        subprocess.run(["git", *words], cwd=root, check=True, timeout=200)
    packed = hatch_build.lessons_and_exercises(root).values()
    assert {str(Path(one).relative_to(hatch_build.COURSE)) for one in packed} == own
    (root / "exercises/task/task.py").write_text("an answer\n")
    with pytest.raises(hatch_build.ChangedExercisesError, match=r"exercises/task/task\.py\. Take the changes back"):
        hatch_build.lessons_and_exercises(root)


def test_what_cites_the_course_names_its_version() -> None:
    version = WheelBuilder(str(REPOSITORY)).metadata.version
    assert f"\nversion: {version}\n" in (REPOSITORY / "CITATION.cff").read_text(encoding="utf-8")


def test_a_wheel_has_every_file_of_the_package_templates_and_style_sheets_included() -> None:
    packed = {Path(file.distribution_path) for file in WheelBuilder(str(REPOSITORY)).recurse_included_files()}
    here = {path.relative_to(REPOSITORY) for path in (REPOSITORY / "course_kit").rglob("*") if path.is_file()}
    wanted = {path for path in here if path.suffix not in {".so", ".pyc", ".tmp"} and path.name != "answers.toml"}
    assert {".html", ".css", ".js", ".svg", ".toml", ".xml"} <= {path.suffix for path in wanted}
    assert wanted <= packed

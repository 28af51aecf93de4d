"""What goes into a student edition, what stays out, and that neither happens without a word."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import edition_plan, release
from course_kit.grading.errors import GradingError
from tests.authoring.conftest import git
from tests.course_copy import REPOSITORY, Course

if TYPE_CHECKING:
    from pathlib import Path


def told(planned: edition_plan.EditionPlan) -> str:
    return "\n".join(release.describe_edition(planned))


def test_everything_that_git_knows_here_has_an_owner() -> None:
    """Red when somebody adds a folder: it stays out of the student edition until edition.toml says whose it is."""
    listed = edition_plan.read_parts()
    undecided = [name for name in edition_plan.list_course_files(REPOSITORY).known if listed.owner(name) == ""]
    assert undecided == []


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("course_kit/quiz/bank.py", "students"),
        ("course_kit/quiz/data/answers.toml", "instructors"),  # whether it is there or not
        ("solutions/x/x.py", "instructors"),
        ("tests/lab/test_calls.py", "students"),
        ("tests/grading/test_engine.py", "instructors"),
        ("course_kit/something_new/x.py", ""),
        ("coursework.md", ""),
    ],
)
def test_the_longest_path_on_the_lists_decides(name: str, owner: str) -> None:
    assert edition_plan.read_parts().owner(name) == owner


def test_new_folders_and_files_stay_out_and_are_named(clone: Course) -> None:
    for name in ("lecture 3/answers.py", "lecture 3/more.py", "exam.md", "course_kit/secrets/x.py"):
        (clone.root / name).parent.mkdir(exist_ok=True)
        (clone.root / name).touch()
    (clone.root / "notebooks" / "07_draft.ipynb").write_text("{}")
    git(clone.root, "add", "lecture 3", "course_kit")  # whether git knows them or not
    planned = edition_plan.plan_edition(clone.root)
    assert planned.undecided == ["course_kit/secrets/x.py", "exam.md", "lecture 3/answers.py", "lecture 3/more.py"]
    assert planned.untracked == ["notebooks/07_draft.ipynb"]
    assert not {*planned.undecided, *planned.untracked} & planned.files.keys()
    said = told(planned)
    assert "are on no list: course_kit/secrets/x.py, exam.md, lecture 3/answers.py, lecture 3/more.py." in said
    assert "git does not know them: notebooks/07_draft.ipynb. To put them in: git add FILE" in said
    assert set(planned.left_out) >= {*planned.undecided, *planned.untracked, "course_kit/authoring/release.py"}


def test_without_git_nobody_knows_what_belongs_to_the_course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(GradingError, match="this folder is no clone"):
        edition_plan.plan_edition(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(GradingError, match="git is not installed"):
        edition_plan.plan_edition(tmp_path)


def test_drills_go_in_without_their_solutions_and_proof_sets(clone: Course) -> None:
    planned = edition_plan.plan_edition(clone.root)
    found = {name for name in planned.files if name.startswith("exercises/drills/")}
    drill = "exercises/drills/dark_lamp"
    assert {name for name in found if name.startswith(drill)} == {
        f"{drill}/exercise.toml", f"{drill}/checks.py", f"{drill}/dark_lamp.py", f"{drill}/dark_lamp.ipynb"
    }  # fmt: skip
    assert f"{drill}/solution/dark_lamp.py" in planned.instructors
    assert f"{drill}/proof/slips.toml" in planned.instructors
    assert "dark_lamp" in planned.drills
    assert "dark_lamp" not in planned.exercises
    assert f"For practice it holds {len(planned.drills)} drills: " in told(planned)

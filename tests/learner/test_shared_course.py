"""A course that is installed once for many: its folder is somebody else's, and learners have files of their own."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from tests.course_copy import TEMPERATURE, Course, copy_with_notebooks
from tests.jupyter_server import allow_root, started
from tests.unprivileged import as_somebody, forbid_writing, give, reachable_folder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MINE = "print('my work')\n"
PROGRAM = f"{TEMPERATURE}.py"


class Learner:
    """Somebody without rights, with a home directory, before a course that is not theirs."""

    def __init__(self, course: Course, home: Path) -> None:
        self.course, self.home = course, home
        home.mkdir()
        give(home)

    def environ(self, **variables: str) -> dict[str, str]:
        own = {"HOME": str(self.home), "XDG_STATE_HOME": str(self.home / "state"), "ROS_LOG_DIR": ""}
        return self.course.environ(**own, **variables)

    def run(self, *arguments: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            as_somebody(*self.course.command(*arguments)), cwd=cwd or self.home, env=self.environ(),
            stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=100, check=False,
        )  # fmt: skip
        assert "Traceback" not in done.stdout + done.stderr, done.stderr
        return done

    def write(self, file: Path, text: str) -> Path:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        give(self.home)
        return file


@pytest.fixture(scope="module")
def course() -> Iterator[Course]:
    with reachable_folder() as folder:
        made = copy_with_notebooks(folder)
        forbid_writing(made.root)
        yield made
        forbid_writing(made.root, forbid=False)


@pytest.fixture
def learner(course: Course) -> Iterator[Learner]:
    with reachable_folder() as folder:
        yield Learner(Course(folder / "home", course.root), folder / "home")


def test_before_there_is_a_copy_list_watch_and_reset_say_how_to_get_one(learner: Learner) -> None:
    assert f"Next exercise: {TEMPERATURE}, after: course-kit copy" in learner.run("list").stdout
    for verb in ("watch", "reset"):
        refused = learner.run(verb, TEMPERATURE)
        assert (refused.returncode, refused.stdout) == (2, "")
        assert "read-only for you" in refused.stderr
        assert "course-kit copy" in refused.stderr


def test_in_a_copy_all_commands_work_on_the_learners_files(learner: Learner) -> None:
    assert learner.run("copy").returncode == 0
    mine = learner.home / "ros2-course" / "exercises" / TEMPERATURE
    starter = (mine / PROGRAM).read_bytes()
    learner.write(mine / PROGRAM, MINE)
    assert f"Next exercise: {TEMPERATURE}, in ros2-course/exercises/{TEMPERATURE}" in learner.run("list").stdout
    assert learner.run("grade", TEMPERATURE, str(mine / PROGRAM)).returncode == 1
    assert "Hint 1 of" in learner.run("hint", TEMPERATURE).stdout
    done = learner.run("reset", TEMPERATURE, cwd=learner.home / "ros2-course" / "notebooks")
    assert done.returncode == 0, done.stderr
    assert (mine / PROGRAM).read_bytes() == starter
    assert (mine / f"{TEMPERATURE}.backup-1.py").read_text() == MINE


def test_the_door_of_a_copy_leads_to_the_course(learner: Learner) -> None:
    assert learner.run("copy", "here").returncode == 0
    listed = subprocess.run(
        as_somebody("./course", "list"), cwd=learner.home / "here", env=learner.environ(), capture_output=True,
        text=True, timeout=60, check=False,
    )  # fmt: skip
    assert f"Next exercise: {TEMPERATURE}, in exercises/{TEMPERATURE}" in listed.stdout, listed.stderr


def test_files_anywhere_are_found_from_where_one_stands_or_by_their_name(learner: Learner) -> None:
    mine = learner.home / "robots"
    assert learner.run("reset", TEMPERATURE, str(mine)).returncode == 0
    assert {file.name for file in mine.iterdir()} == {PROGRAM, f"{TEMPERATURE}.ipynb"}
    learner.write(mine / PROGRAM, MINE)
    assert learner.run("reset", TEMPERATURE, cwd=mine).returncode == 0
    assert (mine / f"{TEMPERATURE}.backup-1.py").read_text() == MINE
    other = learner.write(learner.home / "try.py", MINE)
    assert learner.run("reset", TEMPERATURE, str(other)).returncode == 0
    assert other.read_bytes() == (mine / PROGRAM).read_bytes()
    assert (learner.home / "try.backup-1.py").read_text() == MINE
    wrong = learner.run("reset", TEMPERATURE, "notes.txt")
    assert wrong.returncode == 2
    assert "notes.txt is not one of the files of temperature_service" in wrong.stderr


def test_watch_finds_the_file_where_one_stands(learner: Learner) -> None:
    mine = learner.home / "robots"
    learner.run("reset", TEMPERATURE, str(mine))
    with subprocess.Popen(
        as_somebody(*learner.course.command("watch", TEMPERATURE)), cwd=mine, env=learner.environ(),
        stdout=subprocess.PIPE, text=True,
    ) as watching:  # fmt: skip
        assert watching.stdout is not None
        first = watching.stdout.readline()
        verdict = next(line for line in watching.stdout if "points" in line)
        watching.terminate()
    assert first.startswith(f"Watching {mine / PROGRAM}")
    assert "of 10 points, not passed yet" in verdict


def test_what_cannot_be_written_is_a_sentence(learner: Learner) -> None:
    inside = learner.course.root / "exercises" / "mine.py"
    for arguments in (
        ["reset", TEMPERATURE, str(inside)],
        ["copy", str(learner.course.root.parent / "copy")],
        ["copy", str(learner.course.root / "copy")],
        [
            "class",
            str(learner.course.root / "exercises"),
            "--exercise",
            TEMPERATURE,
            "--out",
            str(inside.parent / "out"),
        ],
    ):
        done = learner.run(*arguments)
        assert done.returncode == 2, (arguments, done.stdout)
        assert str(learner.course.root.parent) in done.stderr
        assert len(done.stderr.strip().splitlines()) == 1


@pytest.mark.parametrize("verb", ["lab", "present"])
def test_jupyterlab_opens_files_that_can_be_saved_and_keeps_them(learner: Learner, verb: str, tmp_path: Path) -> None:
    command = as_somebody(*learner.course.command(verb))
    first = "notebooks/00_welcome.ipynb"
    for _ in range(2):  # the second time there is a copy
        with started([*command, *allow_root()], tmp_path, learner.home, learner.environ()) as server:
            assert server.get(f"contents/{first}?content=0")["writable"] is True
    if verb == "lab":
        assert "read-only for you, so JupyterLab opens your copy" in server.log.read_text()
        assert (learner.home / "ros2-course" / first).is_file()

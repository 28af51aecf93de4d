"""The wheel, installed in an environment of its own: all that a learner needs, and nothing that gives the answers."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest
from hatchling.builders.wheel import WheelBuilder

import hatch_build
from course_kit.dev import suite
from tests.course_copy import REPOSITORY, SOLUTION, TEMPERATURE
from tests.environment.overwritten import overwrite_lark

UV = suite.find_uv() or "uv"  # one of the test tools
MINE = Path("exercises", TEMPERATURE, f"{TEMPERATURE}.py")
SPY = """
import os
from pathlib import Path
import course_kit
kit = Path(course_kit.__file__).parent
print("sees", sorted(os.listdir(kit)), flush=True)
import course_kit.grading
"""


class Installed:
    """The wheel in a virtual environment that takes everything else from the one that the tests run in.

    Attributes:
        folder: where the tests work; the home directory lies in it, too.
        wheel: what was installed.
    """

    def __init__(self, folder: Path, wheel: Path) -> None:
        self.folder, self.wheel = folder, wheel
        self.home = folder / "home"
        self.home.mkdir()
        environment = folder / "an environment"
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(environment)], check=True, timeout=200)
        self.python = environment / "bin" / "python"
        self.packages = Path(sysconfig.get_path("purelib", vars={"base": str(environment)}))
        install = [UV, "pip", "install", "--quiet", "--offline", "--no-deps", "--python", self.python, wheel]
        subprocess.run(install, check=True, timeout=200)
        others = sysconfig.get_path("purelib")
        (self.packages / "others.pth").write_text(f"import site; site.addsitedir({others!r})\n")

    def run(self, *arguments: str, code: int = 0, cwd: Path | None = None) -> str:
        """Run the course's command; returns all that it says."""
        done = subprocess.run(
            [str(self.python), "-m", "course_kit", *arguments],
            cwd=cwd or self.folder,
            env=self.environ(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            encoding="utf-8",
            timeout=300,
            check=False,
        )
        assert done.returncode == code, done.stdout + done.stderr
        return done.stdout + done.stderr

    def environ(self) -> dict[str, str]:
        """Without what the tests set for the clone; ROS itself is in the environment that the tests run in."""
        kept = {name: value for name, value in os.environ.items() if not name.startswith(("COURSE", "PYTHON", "XDG"))}
        return {**kept, "HOME": str(self.home), "AMENT_PREFIX_PATH": sys.prefix}


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    root = tmp_path_factory.mktemp("source") / "a course"
    ignored = shutil.ignore_patterns(*hatch_build.LEFT_OUT[:3], "*.so")
    for name in ("course_kit", *hatch_build.HANDED_OUT):
        shutil.copytree(REPOSITORY / name, root / name, ignore=ignored)
    for name in ("pyproject.toml", "hatch_build.py", "README.md", "LICENSE", ".gitignore"):
        shutil.copy(REPOSITORY / name, root)
    wheel = next(WheelBuilder(str(root)).build(directory=str(root / "dist"), versions=["standard"]))
    return Installed(tmp_path_factory.mktemp("installed"), Path(wheel))


def test_it_holds_the_course_and_no_answers(installed: Installed) -> None:
    with zipfile.ZipFile(installed.wheel) as packed:
        course = {name.removeprefix("course_kit/course/") for name in packed.namelist() if "/course/" in name}
        everything = set(packed.namelist())
        starter = packed.read(f"course_kit/course/{MINE}")
    assert starter != SOLUTION.read_bytes()
    assert {"notebooks/00_welcome.ipynb", "exercises/move_robot/exercise.toml", str(MINE)} <= course
    assert not [name for name in course if {"solution", "proof", "__pycache__"} & set(Path(name).parts)]
    assert "course_kit/quiz/data/answers.toml" not in everything
    assert {"course_kit.pth", "course_kit/interfaces/native/_helper.so"} <= everything


def test_a_learner_works_in_a_folder_of_their_own(installed: Installed) -> None:
    folder = installed.folder / "my robots"
    assert "There is no temperature_service.py of yours here." in installed.run("grade", TEMPERATURE, code=2)
    assert f"are in {folder}" in installed.run("copy", str(folder))
    (folder / "course").unlink()
    (folder / "course").mkdir()  # a package of the learner's
    assert f"are in {folder}" in installed.run("copy", str(folder))
    (folder / "course").rmdir()
    installed.run("copy", str(folder))
    (folder / MINE).write_bytes(SOLUTION.read_bytes())
    assert "10 of 10 points, passed." in installed.run("grade", TEMPERATURE, cwd=folder / "exercises")
    assert "10      1  passed" in installed.run("list", cwd=folder)
    assert "not tried yet" in installed.run("list").splitlines()[1]  # another folder's progress
    command = [str(folder / "course"), "list"]
    said = subprocess.run(command, cwd=folder, env=installed.environ(), capture_output=True, timeout=200, check=True)
    assert b"1 of 5 passed." in said.stdout


def test_uvx_runs_it(installed: Installed, tmp_path: Path) -> None:
    """As `pipx run --spec` does: with its dependencies, in an environment that is made for the command."""
    command = [UV, "tool", "run", "--python", sys.executable, "--from", f"{installed.wheel}[ros]", "course-kit", "list"]
    environ = {**installed.environ(), "HOME": os.environ["HOME"], "AMENT_PREFIX_PATH": ""}  # uv keeps packages there
    done = subprocess.run(command, cwd=tmp_path, env=environ, capture_output=True, text=True, timeout=500, check=False)
    assert done.returncode == 0, done.stderr
    assert "0 of 5 passed." in done.stdout


def test_an_update_of_the_package_brings_new_lessons_and_leaves_what_is_the_learners(installed: Installed) -> None:
    folder = installed.folder / "updated"
    installed.run("copy", str(folder))
    (folder / MINE).write_text("# mine\n")
    given = installed.packages / "course_kit" / "course"
    new = {given / MINE: "# a new starter\n", given / "notebooks" / "07_new.ipynb": "{}"}
    before = {path: path.read_bytes() for path in new if path.exists()}
    try:
        for path, text in new.items():
            path.write_text(text)
        said = installed.run("copy", cwd=folder)
    finally:
        for path in new:
            path.write_bytes(before[path]) if path in before else path.unlink()
    assert f"Yours stay; the new version of {MINE} as {TEMPERATURE}.new-version.py" in said
    assert (folder / MINE).read_text() == "# mine\n"
    assert (folder / MINE).with_name(f"{TEMPERATURE}.new-version.py").read_text() == "# a new starter\n"
    assert (folder / "notebooks" / "07_new.ipynb").is_file()


def test_an_overwritten_package_is_no_reason_not_to_begin(installed: Installed) -> None:
    overwrite_lark(installed.packages)
    said = " ".join(installed.run("doctor").split())
    assert "note packages lark-parser has overwritten files of lark==1.3.1" in said
    assert "--no-deps lark==1.3.1" in said
    assert "installed as a package; you work in" in said


def test_a_submission_sees_no_grader_and_no_lesson(installed: Installed) -> None:
    file = installed.folder / "spy.py"
    file.write_text(SPY)
    said = " ".join(installed.run("grade", TEMPERATURE, str(file), code=1).split())
    assert "No module named 'course_kit.grading'" in said
    shown = said[said.index("sees [") :].partition("]")[0]
    assert "'robot.py'" in shown
    assert not [name for name in ("graders", "course'", "grading", "quiz", "starters") if name in shown]

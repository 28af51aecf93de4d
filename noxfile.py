"""Trials that need more than this environment: other Pythons, a container, a film, a JupyterHub, a real Otter-Grader.

`uvx nox --list` names them, `uvx nox --sessions hub` runs one. What a machine lacks is said, and fails the session.
"""

from __future__ import annotations

import json
import re
import shutil
import tempfile
from pathlib import Path

import nox

nox.options.sessions = ["pythons"]
EXERCISES = sorted(path.parent.name for path in Path("exercises").glob("*/exercise.toml"))
IMAGE = "ros2-course-trial"
OF_THE_COURSE = Path(".venv/bin/python").absolute()


@nox.session(python=["3.10", "3.11", "3.12", "3.13", "3.14"])
def pythons(session: nox.Session) -> None:
    """The course as a newcomer meets it, on each Python of this machine: set-up, solutions, every notebook."""
    code = "import sys; print(getattr(sys, '_base_executable', sys.executable))"
    python = str(session.run("python", "-c", code, silent=True)).strip()
    with tempfile.TemporaryDirectory(prefix="course nox ") as folder:
        course = Path(folder, "my course")
        session.run("git", "clone", "--quiet", ".", str(course), external=True)
        state = {
            "XDG_STATE_HOME": folder,
            "IPYTHONDIR": f"{folder}/ipython",
            "JUPYTER_RUNTIME_DIR": f"{folder}/jupyter",
        }
        environ = {**state, "COURSE_PYTHON": python, "COURSE_KIT_PROGRESS": "off", "VIRTUAL_ENV": None}
        session.chdir(course)
        session.run("./course", "doctor", env=environ, external=True)
        for name in EXERCISES:
            words = ("grade", name, f"solutions/{solution_of(name)}", "--format", "json")
            said = session.run("./course", *words, env=environ, external=True, silent=True)
            require_full_marks(session, name, str(said))
        # The test tools come with the first test.
        session.run("./course", "test", "-q", "-n", "2", "tests/environment", "tests/ros", env=environ, external=True)
        session.run("./course", "test", "-q", "--nbval", "notebooks", "exercises/drills", env=environ, external=True)


@nox.session(python=["3.11", "3.12", "3.13"])
def kilted(session: nox.Session) -> None:
    """The kit with the wheels of ROS 2 Kilted in place of Jazzy's: lab, panels, graders and notebooks, and a table."""
    with tempfile.TemporaryDirectory(prefix="course-kilted-") as folder:
        course = Path(folder, "course")
        session.run("git", "clone", "--quiet", ".", str(course), external=True)
        table = Path("artifacts", "kilted.md").absolute()
        session.chdir(course)
        locked = [word for name in ("course", "numpy", "test") for word in ("-r", f"course_setup/locked/{name}.txt")]
        session.install("--no-deps", "--require-hashes", *locked)
        session.install("ros-kilted-rclpy[fastrtps]==9.1.2", "ros-kilted-common-interfaces==5.5.1", "lark>=1.1,<2")
        session.install("--no-deps", "ros-test-msgs==2.3.0", "-e", ".")
        session.run("python", "-m", "course_kit", "doctor", env={"COURSE_KIT_PROGRESS": "off"})
        rows = ["| what | passed | not passed |", "|---|---|---|"]
        parts = [f"tests/{name}" for name in ("lab", "environment", "ros", "panels", "graders")]
        rows += [run_and_count(session, name, "-m", "pytest", "-q", "-n", "2", name) for name in parts]
        rows.append(
            run_and_count(session, "notebooks", "-m", "pytest", "-q", "--nbval", "notebooks", "exercises/drills")
        )
        table.parent.mkdir(exist_ok=True)
        table.write_text("\n".join(rows) + "\n")
        session.log("the table is in %s; notebooks/jazzy_kilted_lyrical.md has what is known to differ", table)


def run_and_count(session: nox.Session, name: str, *words: str) -> str:
    """A row of the table; what did not pass is in the session's output."""
    said = str(session.run("python", *words, silent=True, success_codes=[0, 1], env={"COURSE_KIT_PROGRESS": "off"}))
    session.log(said)
    passed, failed = (sum(map(int, re.findall(rf"(\d+) {word}", said))) for word in ("passed", "(?:failed|error)"))
    return f"| {name} | {passed} | {failed} |"


@nox.session(python=False)
def container(session: nox.Session) -> None:
    """The Containerfile: doctor, the solutions and a class in it, with podman or docker."""
    engine = next(filter(shutil.which, ("podman", "docker")), None)
    if engine is None:
        session.error("there is no podman and no docker here. Debian, Ubuntu: sudo apt install podman")
    session.run(engine, "build", *session.posargs, "--target", "grader", "-t", IMAGE, "-f", "Containerfile", ".")
    with tempfile.TemporaryDirectory(prefix="course-container-") as folder:
        for student in ("ada", "grace"):
            shutil.copytree("solutions", Path(folder, "inbox", student))
        session.run("chmod", "-R", "a+rX", folder)
        inside = (engine, "run", "--rm", "--entrypoint", "sh", "-v", f"{folder}:/given:ro", IMAGE, "-c")
        session.run(*inside, "course-kit doctor")
        for name in EXERCISES:
            command = f"course-kit grade {name} /given/inbox/ada/{solution_of(name)} --format json"
            require_full_marks(session, name, str(session.run(*inside, command, silent=True)))
        session.run(*inside, f"course-kit class /given/inbox --exercise {EXERCISES[0]} --out results")


@nox.session(python=False)
@nox.parametrize("major", ["5", "6"])
def hub(session: nox.Session, major: str) -> None:
    """A real JupyterHub with three Unix users and a Chromium, by the commands of its guide; as root, some minutes."""
    for program, package in {"npm": "npm", "useradd": "passwd", "git": "git", "chromium": "chromium"}.items():
        if shutil.which(program) is None:
            session.error(f"there is no {program} here. Debian, Ubuntu: apt install {package}")
    session.run(
        str(OF_THE_COURSE),
        "-m",
        "pytest",
        "-v",
        "tests/hub/three_users.py",
        env={"COURSE_KIT_PROGRESS": "off", "COURSE_HUB": major},
    )


@nox.session(python=False)
def picture(session: nox.Session) -> None:
    """The moving picture of lesson 0, filmed anew in Chromium; look at it before you commit it."""
    with tempfile.TemporaryDirectory(prefix="course-picture-") as pillow:
        session.run(str(OF_THE_COURSE), "-m", "pip", "install", "--quiet", "--target", pillow, "pillow>=11,<14")
        environ = {"PYTHONPATH": pillow, "COURSE_KIT_PROGRESS": "off"}
        session.run(str(OF_THE_COURSE), "-m", "tests.browser.moving_picture", env=environ)


@nox.session(python=False)
def otter(session: nox.Session) -> None:
    """Points of a real Otter-Grader beside ours; it needs `pip install -e ".[bench]"` in the course's environment."""
    asked = "import importlib.util as found; print(found.find_spec('otter') is not None)"
    if str(session.run(str(OF_THE_COURSE), "-c", asked, silent=True)).strip() != "True":
        session.error('there is no Otter-Grader here. Run: .venv/bin/python -m pip install -e ".[bench]"')
    session.run(str(OF_THE_COURSE), "-m", "pytest", "-v", "tests/otter/real_otter.py")


def solution_of(exercise: str) -> Path:
    """What is graded of `solutions`: a program, or the folder of an exercise that asks for several files."""
    program = Path(exercise, f"{exercise}.py")
    return program if Path("solutions", program).is_file() else program.parent


def require_full_marks(session: nox.Session, exercise: str, said: str) -> None:
    """A solution has full marks."""
    report = json.loads(said[said.index("{") :])
    if report["score"] != report["max_score"]:
        session.error(f"{exercise}: {report['score']} of {report['max_score']} points")

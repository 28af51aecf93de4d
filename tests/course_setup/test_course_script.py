"""`./course` as a newcomer meets it: in a folder with a space, interrupted, moved, on the wrong machine.

The installation itself is stood in for by `stand_in_uv` (tests must pass without a network); that the real one
works is shown by the fact that this suite runs, since `./course test` had to set it up.
"""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest

from course_kit.cli.main import build_parser
from tests.course_clone import BASE_PYTHON, STAND_IN_UV, Clone


def test_first_use_sets_up_and_passes_the_command_on_and_later_uses_do_not(clone: Clone) -> None:
    first = clone.course("grade", "temperature_service", "a file.py")
    assert first.stdout == f"cli {clone.environment} grade temperature_service a file.py\n"
    assert "[1/2]" in first.stderr
    assert "[2/2]" in first.stderr
    again = clone.course("doctor")
    assert again.stdout == f"cli {clone.environment} doctor\n"
    assert again.stderr == ""
    assert clone.calls() == ["venv", "pip"]
    assert "[ros]" in clone.log.read_text()


def test_a_set_up_compiles_the_course(clone: Clone) -> None:
    """Else each grading would, where Python may not keep what it has compiled."""
    clone.course("doctor", PYTHONDONTWRITEBYTECODE="1")
    kit = clone.root / "course_kit"
    modules = {path.relative_to(kit) for path in kit.rglob("*.py") if "templates" not in path.parts}
    compiled = {path.parents[1].relative_to(kit) / f"{path.name.split('.')[0]}.py" for path in kit.rglob("*.pyc")}
    assert modules <= compiled


def test_it_works_through_a_link_and_from_another_folder(clone: Clone, tmp_path: Path) -> None:
    clone.course("doctor")
    link = tmp_path / "link"
    link.symlink_to(clone.root / "course")
    done = subprocess.run(
        [link, "doctor"], cwd=tmp_path, env=clone.environ(), capture_output=True, text=True, check=False
    )
    assert done.stdout == f"cli {clone.environment} doctor\n"


def test_a_file_in_the_folder_one_is_in_takes_the_place_of_no_module(clone: Clone, tmp_path: Path) -> None:
    (tmp_path / "runpy.py").write_text("raise SystemExit('not meant')\n")
    (tmp_path / "course_kit" / "cli").mkdir(parents=True)
    (tmp_path / "course_kit" / "cli" / "main.py").write_text("raise SystemExit('another course')\n")
    for _ in range(2):
        done = clone.course("doctor", cwd=tmp_path)
        assert done.stdout == f"cli {clone.environment} doctor\n", done.stderr


def test_ctrl_c_half_way_says_so_and_the_next_run_goes_on(clone: Clone, tmp_path: Path) -> None:
    started = clone.half_way(tmp_path)
    os.killpg(started.pid, signal.SIGINT)
    _, errors = started.communicate(timeout=120)
    assert started.returncode == 130
    assert "stopped half-way. Run the same command again" in errors
    assert clone.course("doctor").stdout == f"cli {clone.environment} doctor\n"


def test_a_failed_installation_says_what_to_do_and_is_not_taken_for_done(clone: Clone) -> None:
    failed = clone.course("doctor", STAND_IN_RESULT="1")
    assert failed.returncode == 2
    assert "the installation did not finish" in failed.stderr
    assert clone.course("doctor").returncode == 0


@pytest.mark.parametrize(
    ("tool", "text", "sentence"),
    [
        ("uname", '#!/bin/sh\n[ "$1" = -s ] && echo Darwin || echo arm64\n', "this is Darwin on arm64"),
        ("uname", '#!/bin/sh\n[ "$1" = -s ] && echo Linux || echo aarch64\n', "this is Linux on aarch64"),
        ("getconf", "#!/bin/sh\necho glibc 2.27\n", "glibc 2.28 or newer, but this is glibc 2.27"),
        ("getconf", "#!/bin/sh\nexit 1\n", "this Linux has another C library"),
    ],
)
def test_the_wrong_platform_gets_one_sentence(clone: Clone, tool: str, text: str, sentence: str) -> None:
    clone.tool(tool, text)
    done = clone.course("lab")
    assert done.returncode == 2
    assert sentence in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert "RoboStack" in done.stderr
    assert not (clone.root / ".venv").exists()


def test_another_ros_distribution_is_named(clone: Clone) -> None:
    done = clone.course("lab", ROS_DISTRO="humble")
    assert done.returncode == 2
    assert "ROS 2 'humble' is sourced" in done.stderr


def test_the_packages_of_the_lock_are_installed_and_nothing_else(clone: Clone) -> None:
    clone.course("test")
    packages, course = [line.split() for line in clone.log.read_text().splitlines() if line.startswith("pip")]
    files = [name.removeprefix("course_setup/locked/") for name in packages if name.endswith(".txt")]
    assert files == ["build.txt", "pip.txt", "course.txt", "numpy.txt", "ros.txt", "test-ros.txt", "test.txt"]
    assert {"--no-deps", "--require-hashes"} <= set(packages)
    assert course[-5:] == [
        "--build-constraints",
        "course_setup/locked/build.txt",
        "--no-deps",
        "-e",
        ".[ros,test-ros,test]",
    ]
    clone.course("test")
    (clone.root / "course_setup/locked/test.txt").write_text("")
    assert "ready" in clone.course("test").stderr  # a lock that has changed


@pytest.mark.parametrize(
    "part", ["ros2_course_kit.json", "labextension/package.json", "labextension/static/remoteEntry.js"]
)
def test_what_jupyter_loads_is_installed_again_when_it_changes(clone: Clone, part: str) -> None:
    clone.course("doctor")
    with (clone.root / "course_kit/jupyter_config" / part).open("a") as file:
        file.write("\n")
    assert "ready" in clone.course("doctor").stderr


def test_the_newest_packages_are_installed_where_somebody_asks_and_stay(clone: Clone) -> None:
    clone.course("doctor")
    clone.course("doctor", COURSE_UNLOCKED="1")
    assert clone.calls() == ["venv", "pip", "venv", "pip"]  # an environment of its own: what fits would stay old
    assert clone.log.read_text().splitlines()[-1].endswith("pip -e .[ros]")
    for unlocked in ("1", ""):
        assert clone.course("doctor", COURSE_UNLOCKED=unlocked).stderr == ""
    with (clone.root / "pyproject.toml").open("a") as file:
        file.write("# edited\n")
    clone.course("doctor")
    assert "--require-hashes" in clone.log.read_text().splitlines()[-2]
    assert "ready" in clone.course("doctor", COURSE_UNLOCKED="1").stderr


@pytest.mark.parametrize("words", [["--find-links", "../a bundle"], ["--find-links=../a bundle"], []])
def test_a_set_up_from_a_bundle_uses_no_network(clone: Clone, tmp_path: Path, words: list[str]) -> None:
    bundle = tmp_path / "a bundle"
    bundle.mkdir()
    (bundle / "pip-26.0-py3-none-any.whl").touch()
    variables = {} if words else {"COURSE_FIND_LINKS": str(bundle)}
    done = clone.course("grade", *words, "temperature_service", **variables)
    assert done.stdout == f"cli {clone.environment} grade temperature_service\n", done.stderr
    installs = [line for line in clone.log.read_text().splitlines() if line.startswith("pip")]
    assert [line for line in installs if f"--no-index --find-links {bundle} " not in line] == []
    assert clone.course(*words, "doctor", **variables).stderr == ""


def test_a_bundle_that_is_none_or_not_whole_is_told(clone: Clone, tmp_path: Path) -> None:
    refused = clone.course("lab", "--find-links", str(tmp_path / "nowhere"))
    assert (refused.returncode, len(refused.stderr.splitlines())) == (2, 1)
    assert f"There are no wheels in {tmp_path}/nowhere" in refused.stderr
    assert "--find-links needs the name of a folder" in clone.course("lab", "--find-links").stderr
    assert clone.calls() == []
    (tmp_path / "pip-26.0-py3-none-any.whl").touch()
    failed = clone.course("lab", f"--find-links={tmp_path}", STAND_IN_RESULT="1")
    assert f"Everything has to be in {tmp_path}, for this Python" in failed.stderr


def test_the_python_of_a_sourced_jazzy_is_the_one_in_path(clone: Clone) -> None:
    clone.sourced()
    (clone.tools / "ros_python").rename(clone.tools / "python3")
    done = clone.course("doctor", ROS_DISTRO="jazzy", COURSE_PYTHON="")
    assert done.returncode == 0, done.stderr
    assert "--system-site-packages" in clone.log.read_text()


def test_a_python_that_does_not_fit_is_named(clone: Clone) -> None:
    clone.tool("stand_in_old_python", "#!/bin/sh\nexit 1\n")
    done = clone.course("lab", COURSE_PYTHON=str(clone.tools / "stand_in_old_python"))
    assert done.returncode == 2
    assert "not a CPython from 3.10 to 3.14" in done.stderr


def test_a_python_without_venv_says_what_to_install(clone: Clone) -> None:
    (clone.tools / "uv").unlink()
    clone.tool(
        "stand_in_python_without_venv",
        f'#!/bin/sh\ncase "$*" in *ensurepip*) exit 99 ;; *) exec {BASE_PYTHON} "$@" ;; esac\n',
    )
    done = clone.course("lab", COURSE_PYTHON=str(clone.tools / "stand_in_python_without_venv"))
    assert done.returncode == 2
    assert "sudo apt install python3-venv" in done.stderr


BRINGS_UV = """#!/bin/sh
case "$*" in *ensurepip*) ;; *) exec {python} "$@" ;; esac
echo "$@" >"{log}.pip"
while [ "$1" != --target ]; do shift; done
mkdir -p "$2/bin" && cp "{uv}" "$2/bin/uv"
"""


def without_uv(clone: Clone, uv: str = STAND_IN_UV) -> str:
    """A Python on a machine without uv, whose pip downloads this one."""
    (clone.tools / "uv").rename(clone.tools / "of_pypi")
    clone.tool("of_pypi", uv)
    words = {"python": BASE_PYTHON, "log": clone.log, "uv": clone.tools / "of_pypi"}
    clone.tool("stand_in_python", BRINGS_UV.format(**words))
    return str(clone.tools / "stand_in_python")


def test_where_there_is_no_uv_the_locked_one_is_downloaded_once(clone: Clone, tmp_path: Path) -> None:
    python = without_uv(clone)
    (tmp_path / "any.whl").touch()
    done = clone.course("doctor", f"--find-links={tmp_path}", COURSE_PYTHON=python)
    assert done.stdout == f"cli {clone.environment} doctor\n", done.stderr
    asked = Path(f"{clone.log}.pip").read_text()
    assert "--require-hashes -r course_setup/locked/uv.txt" in asked
    assert f"--no-index --find-links {tmp_path}" in asked
    Path(f"{clone.log}.pip").unlink()
    with (clone.root / "pyproject.toml").open("a") as file:
        file.write("# edited\n")
    assert clone.course("doctor", COURSE_PYTHON=python).returncode == 0
    assert not Path(f"{clone.log}.pip").exists()
    others = [path.name for path in clone.environments() if path != clone.environment]
    assert sorted(name.partition("-")[0] for name in others) == ["uv", "wheels"]


def test_a_uv_that_cannot_be_downloaded_is_named_with_what_pip_says(clone: Clone) -> None:
    python = without_uv(clone)
    says = "#!/bin/sh\ncase $* in *ensurepip*) echo no wheel; exit 1 ;; esac\n"
    clone.tool("stand_in_python", f'{says}exec {BASE_PYTHON} "$@"\n')
    done = clone.course("lab", COURSE_PYTHON=python)
    assert done.returncode == 2
    _, of_pip, told = done.stderr.splitlines()
    assert of_pip == "no wheel"
    assert "uv, which installs the course, could not be downloaded; the lines above say why." in told


def test_the_commands_it_shows_are_those_there_are(clone: Clone) -> None:
    block = clone.course("help").stdout.split("\n\n")[1].splitlines()
    shown = {line.split()[0] for line in block if line.startswith("  ")}
    assert len(shown) == len(block)
    known = build_parser().format_help().split()
    assert [name for name in shown - {"test"} if name not in known] == []
    assert {"list", "grade", "watch", "hint", "solution", "reset", "doctor"} <= shown

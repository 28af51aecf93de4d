"""Two packages that bring the same files: `lark`, and its old name `lark-parser`, which the ROS wheels ask for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

from course_kit.environment import packages
from tests.environment.overwritten import overwrite_lark

PYPROJECT = Path(__file__).resolve().parent.parent.parent / "pyproject.toml"


def look(folder: Path) -> str:
    """What is found by a Python that has the packages in the folder."""
    return subprocess.run(
        [
            sys.executable,
            "-c",
            "from course_kit.environment.packages import find_damaged_package; print(find_damaged_package())",
        ],
        env={**os.environ, "PYTHONPATH": str(folder)},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    ).stdout


def test_the_environment_of_these_tests_has_one_good_lark() -> None:
    assert packages.find_damaged_package() == ""
    done = subprocess.run([sys.executable, "-W", "error", "-c", "from lark import ParseTree"], check=False)
    assert done.returncode == 0


def test_one_that_has_lost_a_file_to_another_is_named_with_its_version(tmp_path: Path) -> None:
    overwrite_lark(tmp_path)
    assert look(tmp_path) == "lark==1.3.1\n"


def lay_down_wheel(folder: Path, name: str, version: str, *requirements: str) -> None:
    """A wheel with nothing in it but what it asks for."""
    information = f"{name}-{version}.dist-info"
    asked = "".join(f"Requires-Dist: {requirement}\n" for requirement in requirements)
    with zipfile.ZipFile(folder / f"{name}-{version}-py3-none-any.whl", "w") as wheel:
        wheel.writestr(f"{information}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n{asked}")
        wheel.writestr(f"{information}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr(f"{information}/RECORD", "")


def resolved(project: Path) -> list[str]:
    """What uv would install for a project from the wheels beside it, without a network."""
    uv = shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]))
    assert uv
    command = [uv, "pip", "compile", "--no-index", "--find-links", ".", "--no-annotate", "--no-header", "--quiet"]
    return subprocess.run(
        [*command, "--python", sys.executable, "pyproject.toml"],
        cwd=project, capture_output=True, text=True, timeout=60, check=True,
    ).stdout.splitlines()  # fmt: skip


def test_uv_leaves_out_the_old_name_that_the_wheels_of_ros_ask_for(tmp_path: Path) -> None:
    lay_down_wheel(tmp_path, "lark", "1.3.1")
    lay_down_wheel(tmp_path, "lark_parser", "0.12.0")
    lay_down_wheel(tmp_path, "ros_rosidl_parser", "4.6.6", "lark-parser")
    project = '[project]\nname = "course"\nversion = "1"\ndependencies = ["lark>=1.1,<2", "ros-rosidl-parser"]\n'
    settings = tmp_path / "pyproject.toml"
    settings.write_text(project)
    assert resolved(tmp_path) == ["lark==1.3.1", "lark-parser==0.12.0", "ros-rosidl-parser==4.6.6"]
    ours = PYPROJECT.read_text(encoding="utf-8").partition("\n[tool.uv]\n")[2].partition("\n[")[0]
    settings.write_text(f"{project}[tool.uv]\n{ours}\n")
    assert resolved(tmp_path) == ["lark==1.3.1", "ros-rosidl-parser==4.6.6"]

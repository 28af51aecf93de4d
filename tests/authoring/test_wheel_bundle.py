"""`course-kit bundle`, with real pip on a folder of small packages: the real ones are 209 MB."""

from __future__ import annotations

import hashlib
import zipfile
from typing import TYPE_CHECKING

import pytest

from course_kit.authoring import wheel_bundle
from course_kit.authoring.wheel_bundle import LockedPackage
from course_kit.grading.errors import GradingError
from tests.course_copy import REPOSITORY

if TYPE_CHECKING:
    from pathlib import Path


def wheel(folder: Path, name: str, tag: str) -> str:
    """A package with nothing in it; returns its hash."""
    path = folder / f"{name}-1.0-{tag}.whl"
    info = f"{name}-1.0.dist-info"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{info}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        archive.writestr(f"{info}/WHEEL", f"Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: {tag}\n")
        archive.writestr(f"{info}/RECORD", "")
    return f"sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}"


@pytest.fixture
def source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The only place from which pip takes packages."""
    folder = tmp_path / "source"
    folder.mkdir()
    for name, value in {"CONFIG_FILE": "/dev/null", "NO_INDEX": "1", "FIND_LINKS": str(folder)}.items():
        monkeypatch.setenv(f"PIP_{name}", value)
    return folder


def test_the_wheels_for_another_python_and_an_older_linux_are_downloaded(source: Path, tmp_path: Path) -> None:
    tags = {
        "plain": "py3-none-any",
        "compiled": "cp312-cp312-manylinux_2_17_x86_64",
        "stable": "cp310-abi3-linux_x86_64",
    }
    wanted = [LockedPackage(name, "1.0", "", (wheel(source, name, tag),)) for name, tag in tags.items()]
    wheel(source, "compiled", "cp313-cp313-manylinux_2_17_x86_64")
    wheel(source, "compiled", "cp312-cp312-manylinux_2_39_x86_64")  # for newer ones than `./course` asks for
    bundle = tmp_path / "a bundle"
    bundle.mkdir()
    wheel_bundle.download_packages(wanted, "3.12", bundle)
    assert {path.name for path in bundle.iterdir()} == {f"{name}-1.0-{tag}.whl" for name, tag in tags.items()}


def test_a_file_that_is_not_the_one_of_the_lock_is_refused(source: Path, tmp_path: Path) -> None:
    wheel(source, "plain", "py3-none-any")
    with pytest.raises(GradingError, match=r"Python 3\.12 did not finish; the lines above say why"):
        wheel_bundle.download_packages([LockedPackage("plain", "1.0", "", ("sha256:" + "0" * 64,))], "3.12", tmp_path)
    assert list(tmp_path.glob("*.whl")) == []


def test_it_holds_what_a_set_up_installs_and_what_builds_the_course() -> None:
    found = {package.name for package in wheel_bundle.locked_packages(REPOSITORY, "3.12")}
    assert {"pip", "jupyterlab", "numpy", "ros-rclpy", "hatchling", "editables", "ziglang", "setuptools"} <= found
    assert "pytest" not in found
    assert "pytest" in {package.name for package in wheel_bundle.locked_packages(REPOSITORY, "3.12", tests=True)}
    assert ("tomli" in found, "appnope" in found) == (False, False)
    assert "tomli" in {package.name for package in wheel_bundle.locked_packages(REPOSITORY, "3.10")}

"""The lock fits pyproject.toml, is whole, and holds one version of each package for each Python."""

from __future__ import annotations

import sys
from importlib import metadata
from typing import TYPE_CHECKING, Any

import pytest
from packaging.requirements import Requirement

from course_kit.authoring import wheel_bundle
from course_kit.dev import lock
from tests.course_copy import REPOSITORY

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

FILES = sorted(path.stem for path in (REPOSITORY / wheel_bundle.LOCK).glob("*.txt"))
INSTALLED_TOGETHER = {
    "wheels": ["pip", "course", "numpy", "ros"],
    "wheels with tests": ["pip", "course", "numpy", "ros", "test-ros", "test"],
    "a sourced ROS": ["pip", "course", "numpy-1"],
    "a sourced ROS with tests": ["pip", "course", "numpy-1", "test"],
    "build": ["build"],
}
NOT_INSTALLED = {"lark-parser"}  # the old name of lark: see [tool.uv] in pyproject.toml


def versions(names: list[str], python: str) -> dict[str, set[str]]:
    found: dict[str, set[str]] = {}
    for package in wheel_bundle.read_lock(REPOSITORY, names):
        if package.is_for(python):
            found.setdefault(package.name, set()).add(package.version)
    return found


def asked_of(part: str) -> list[str]:
    project: dict[str, Any] = tomllib.loads((REPOSITORY / "pyproject.toml").read_text("utf-8"))
    if part == "build":
        return list(project["build-system"]["requires"])
    extras: dict[str, list[str]] = project["project"]["optional-dependencies"]
    return [*project["project"]["dependencies"], *flattened(extras, INSTALLED_TOGETHER[part])]


def flattened(extras: dict[str, list[str]], names: Iterable[str]) -> Iterator[str]:
    """What extras ask for; one may ask for others, as `ros2-course-kit[site]`."""
    for line in (line for name in names for line in extras.get(name, [])):
        requirement = Requirement(line)
        if requirement.name == "ros2-course-kit":
            yield from flattened(extras, requirement.extras)
        else:
            yield line


@pytest.mark.parametrize("part", [part for part in INSTALLED_TOGETHER if "sourced" not in part])
@pytest.mark.parametrize("python", lock.PYTHONS)
def test_it_has_what_pyproject_asks_for(part: str, python: str) -> None:
    """Red when a dependency was added or changed; `course-kit dev lock` then renews it."""
    locked = versions(INSTALLED_TOGETHER[part], python)
    missing = []
    for requirement in map(Requirement, asked_of(part)):
        if requirement.marker and not requirement.marker.evaluate({"python_version": python}):
            continue
        found = locked.get(requirement.name.lower(), set())
        if not found or not all(requirement.specifier.contains(version) for version in found):
            missing.append(str(requirement))
    assert missing == []


@pytest.mark.parametrize("part", INSTALLED_TOGETHER)
def test_what_is_installed_together_has_one_version_of_each_package(part: str) -> None:
    for python in lock.PYTHONS:
        several = {name: found for name, found in versions(INSTALLED_TOGETHER[part], python).items() if len(found) > 1}
        if python == "3.11":
            several.pop("soupsieve", None)  # 3.11.4 and 3.11.5 get different ones
        assert several == {}, python


def test_everything_that_its_packages_ask_for_is_in_it() -> None:
    """As far as they are installed here: nothing else is, so what is missing would be found missing by a learner."""
    python = "{}.{}".format(*sys.version_info)
    locked = versions(INSTALLED_TOGETHER["wheels with tests"], python)
    looked_at, missing = 0, []
    for name, (version,) in ((name, found) for name, found in locked.items() if len(found) == 1):
        try:
            installed = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        if installed.version != version:  # where somebody has resolved afresh
            continue
        looked_at += 1
        for requirement in map(Requirement, installed.requires or ()):
            wanted = requirement.name.lower().replace("_", "-").replace(".", "-")
            if requirement.marker and not requirement.marker.evaluate({"extra": ""}):
                continue
            if wanted not in locked and wanted not in NOT_INSTALLED:
                missing.append(f"{name} needs {requirement}")
    assert missing == []
    assert looked_at > 0


@pytest.mark.parametrize("name", FILES)
def test_its_files_are_as_the_command_writes_them_and_name_no_host(name: str) -> None:
    text = (REPOSITORY / wheel_bundle.LOCK / f"{name}.txt").read_text("utf-8")
    assert text == lock.text_of(name, wheel_bundle.parse_lock(text))
    assert "://" not in text
    assert "sha256:" in text

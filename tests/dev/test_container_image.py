"""The trial of the container: what it runs, and when a lesson in it counts as another one."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest

from course_kit.dev import container_image
from course_kit.dev.container_image import ContainerEngine


def notebook(*errors: str) -> str:
    outputs = [[{"output_type": "error", "ename": name}] if name else [{"output_type": "stream"}] for name in errors]
    return json.dumps({"cells": [{"cell_type": "markdown"}, *({"outputs": each} for each in outputs)]})


@pytest.mark.parametrize(
    ("ran", "said"),
    [
        (notebook("", "LabError"), ""),
        (f"a line before it\n{notebook('', 'LabError')}", ""),
        (notebook("KeyError", "LabError"), "cell 1 has KeyError"),
        (notebook("", ""), "cell 2 has no error"),
        (notebook(""), "the notebook that came back is another one."),
        ("nothing", "the notebook that came back is another one."),
    ],
)
def test_a_lesson_has_to_end_as_it_is_stored(ran: str, said: str) -> None:
    assert container_image.differs(notebook("", "LabError"), ran) == said


@pytest.mark.parametrize("name", container_image.ENGINES)
def test_a_line_of_sh_reaches_the_container_whole(name: str, tmp_path: Path) -> None:
    """A stand-in for the engine hands on what it is asked to run, in which quotes and spaces have to survive."""
    stand_in = tmp_path / name
    stand_in.write_text('#!/bin/sh\nfor last; do :; done\ncase $1 in from | rm) echo it ;; *) sh -c "$last" ;; esac\n')
    stand_in.chmod(0o755)
    command = ContainerEngine(name).run('echo "it\'s  $((1 + 1))"', tmp_path)
    path = f"{tmp_path}:/usr/bin:/bin"
    done = subprocess.run(command, env={"PATH": path}, capture_output=True, text=True, timeout=20, check=True)
    assert done.stdout.splitlines()[0] == "it's  2"


def test_without_an_engine_it_says_how_to_get_one(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert container_image.main([]) == 2
    assert "no podman and no docker and no buildah here" in capsys.readouterr().err
    assert container_image.main(["--engine", "docker"]) == 2
    assert "there is no docker here" in capsys.readouterr().err


def test_the_containers_install_what_is_locked_and_nothing_else() -> None:
    file = (Path(__file__).parents[2] / "Containerfile").read_text(encoding="utf-8")
    installs = [line for line in file.replace("\\\n", "").splitlines() if "pip install" in line]
    assert all(one.count("--no-deps") == one.count("pip install") for one in installs)
    assert installs

"""What `./course lab` does before JupyterLab starts: root and containers."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest
from jupyterlab_server.config import get_static_page_config

from course_kit import environment
from course_kit.cli.main import main
from course_kit.integrations import jupyter

if TYPE_CHECKING:
    from pathlib import Path


def test_root_in_a_container_gets_what_jupyter_asks_for_and_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert jupyter.root_arguments([], 0, "/.dockerenv") == ["--allow-root"]
    assert "root in a container (/.dockerenv)" in capsys.readouterr().err


def test_root_elsewhere_is_refused_and_told_what_to_do() -> None:
    with pytest.raises(jupyter.LabStartError, match="Log in as an ordinary user, or add --allow-root") as caught:
        jupyter.root_arguments(["--port=8888"], 0, "")
    assert "lab --allow-root" in str(caught.value)


def test_the_refusal_is_one_line_and_ends_with_2_and_nothing_is_made(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(environment.paths, "sign_of_container", lambda: "")  # as on a machine of its own
    assert main(["lab", str(tmp_path / "folder")]) == 2
    assert not (tmp_path / "folder").exists()
    said = capsys.readouterr().err
    assert said.startswith("course-kit: JupyterLab does not run as root")
    assert len(said.splitlines()) == 1


def test_a_learners_lab_has_no_menu_of_nbgrader(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    environ = jupyter.lab_command(tmp_path, "", ["--allow-root"])[1]
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", environ["JUPYTER_CONFIG_PATH"])
    assert get_static_page_config()["disabledExtensions"] == {"@jupyter/nbgrader": True}

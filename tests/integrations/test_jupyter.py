"""What `./course lab` does before JupyterLab starts: root, containers, and folders that cannot be written."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.integrations import jupyter
from tests.course_copy import Course
from tests.jupyter_server import allow_root, started

NOWHERE = "/proc/nonexistent"
OF_JUPYTER = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")


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
    assert jupyter.run_lab([str(tmp_path / "folder")]) == 2
    assert not (tmp_path / "folder").exists()
    said = capsys.readouterr().err
    assert said.startswith("course-kit: JupyterLab does not run as root")
    assert len(said.splitlines()) == 1


@pytest.fixture
def state(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    for name in (*OF_JUPYTER, "JUPYTER_CONFIG_PATH", "JUPYTER_PATH", "XDG_DATA_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    return tmp_path / "state" / "ros2-course-kit"


def test_one_folder_that_cannot_be_written_is_replaced_and_still_read(
    state: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As `~/.jupyter` is, after a `sudo jupyter lab`; here a file is in its place, which stops root, too."""
    home = tmp_path / "home"
    (home / ".local" / "share").mkdir(parents=True)
    (home / ".local" / "share" / "jupyter").touch()
    monkeypatch.setenv("HOME", str(home))
    assert set(jupyter.replacement_folders()) == {"JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"}
    monkeypatch.setenv("JUPYTER_DATA_DIR", "/proc/self")  # a folder that is there, and nobody can write
    monkeypatch.setenv("JUPYTER_PATH", "/mine")
    found = jupyter.replacement_folders()
    assert found["JUPYTER_PATH"] == "/mine:/proc/self"
    assert Path(found["JUPYTER_DATA_DIR"]).is_relative_to(state)


def test_jupyterlab_starts_without_a_home(tmp_path: Path) -> None:
    course = Course(tmp_path)
    environ = {name: value for name, value in course.environ().items() if not name.startswith(("JUPYTER", "XDG"))}
    environ |= {"HOME": NOWHERE, "TMPDIR": str(tmp_path)}
    command = [*course.command("lab", str(tmp_path / "mine")), *allow_root()]
    with started(command, tmp_path, course.root, environ) as server:
        kernel = server.post("kernels")["id"]
        assert server.get(f"kernels/{kernel}")["name"] == "python3"
        log = server.log.read_text()
    assert f"Jupyter's folders in your home directory cannot be written; it keeps its files below {tmp_path}" in log
    assert "Traceback" not in log

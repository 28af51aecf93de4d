"""What a JupyterHub starts for each user, up to the moment at which JupyterHub itself takes over.

The whole, with a real hub and three users, is `uvx nox --sessions hub` (tests/hub).
"""

from __future__ import annotations

import ast
import os
import sys
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.cli import main
from course_kit.integrations import jupyter
from tests.hub import guide

FOLDER = Path("/home/ada/ros2-course")
LESSON = "notebooks/00_welcome.ipynb"
URL = "JUPYTERHUB_SERVICE_URL"


class Started(Exception):  # noqa: N818 - no error
    """Stands in for the server that would take this process's place."""


@pytest.fixture
def on_a_hub(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a JupyterHub brings, and a stand-in for what is started."""

    def start(path: str, command: list[str], environ: dict[str, str]) -> None:
        raise Started(path, command, environ)

    monkeypatch.setenv(URL, "http://127.0.0.1:1/user/ada/")
    monkeypatch.delenv("JUPYTERHUB_ROOT_DIR", raising=False)
    monkeypatch.delenv("JUPYTERHUB_DEFAULT_URL", raising=False)
    monkeypatch.setattr(jupyter, "find_spec", lambda _: "found")
    monkeypatch.setattr(os, "execve", start)


@pytest.mark.parametrize(
    ("root_dir", "lesson", "shown", "opens"),
    [
        (None, LESSON, FOLDER, f"/lab/tree/{LESSON}"),
        ("/home/ada", LESSON, Path("/home/ada"), f"/lab/tree/ros2-course/{LESSON}"),
        ("/", LESSON, Path("/"), f"/lab/tree/home/ada/ros2-course/{LESSON}"),
        ("/", "", Path("/"), "/lab"),  # the folder could not be made
    ],
)
def test_the_server_shows_the_learners_folder_or_the_one_of_the_administrator_that_holds_it(
    root_dir: str | None, lesson: str, shown: Path, opens: str
) -> None:
    environ = {} if root_dir is None else {"JUPYTERHUB_ROOT_DIR": root_dir}
    assert jupyter.shown_on_hub(FOLDER, lesson, environ) == (shown, opens)


def test_a_folder_without_the_lessons_is_not_shown_and_the_log_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert jupyter.shown_on_hub(FOLDER, LESSON, {"JUPYTERHUB_ROOT_DIR": "/srv"}) == (FOLDER, f"/lab/tree/{LESSON}")
    odd = Path("/home/ada #1/ros2-course")
    assert (
        jupyter.shown_on_hub(odd, LESSON, {"JUPYTERHUB_ROOT_DIR": "/"})[1]
        == f"/lab/tree/home/ada%20%231/ros2-course/{LESSON}"
    )
    assert "c.Spawner.notebook_dir is /srv, and the lessons are in /home/ada/ros2-course" in capsys.readouterr().err


def test_the_command_is_the_hubs_own_on_the_users_folder_and_domain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("JUPYTERHUB_DEFAULT_URL", raising=False)
    command, environ = jupyter.hub_command(FOLDER, LESSON, ["--debug"])
    assert command[0] == sys.executable
    assert "from jupyterhub.singleuser import main" in command[2]
    assert f"--ServerApp.root_dir={FOLDER}" in command
    assert command[-1] == "--debug"
    assert environ["JUPYTERHUB_DEFAULT_URL"] == f"/lab/tree/{LESSON}"
    assert environ["ROS_DOMAIN_ID"] == str(environment.apply_settings().domain_id)
    monkeypatch.setenv("JUPYTERHUB_DEFAULT_URL", "/tree")  # c.Spawner.default_url
    assert jupyter.hub_command(FOLDER, LESSON, [])[1]["JUPYTERHUB_DEFAULT_URL"] == "/tree"


@pytest.mark.usefixtures("on_a_hub")
def test_outside_of_a_hub_it_says_what_to_run_instead(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delenv(URL)
    assert main.main([jupyter.HUB_VERB]) == 2
    said = capsys.readouterr().err
    assert "only a JupyterHub can start hub-singleuser" in said
    assert said.rstrip().endswith("lab.")
    assert len(said.splitlines()) == 1


@pytest.mark.usefixtures("on_a_hub")
def test_root_is_refused_as_jupyter_refuses_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 0)
    monkeypatch.setattr(environment.paths, "sign_of_container", lambda: "")
    assert main.main([jupyter.HUB_VERB]) == 2
    assert "hub-singleuser --allow-root" in capsys.readouterr().err


def test_the_configuration_of_the_guide_starts_what_the_guide_installs() -> None:
    configured = ast.parse(guide.block("Configure the hub", "python"))
    settings = {ast.unparse(one.targets[0]): one.value for one in configured.body if isinstance(one, ast.Assign)}
    assert ast.literal_eval(settings["c.Spawner.cmd"]) == [f"{guide.COURSE}/course", jupyter.HUB_VERB]
    proxy = ast.literal_eval(settings["c.ConfigurableHTTPProxy.command"])
    assert proxy == [f"{guide.TOOLS}/node_modules/.bin/configurable-http-proxy"]
    installed = guide.block("Install it once", "sh")
    assert f"npm install --prefix {guide.TOOLS} " in installed
    assert '-m pip install -e ".[hub]"' in installed

"""A learner whose home directory is missing: JupyterLab, lesson 1 and a grade work as ever."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

from tests.browser.learner import learner

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

NO_HOME = {
    "HOME": "/proc/nonexistent",  # where not even root can make it
    "XDG_STATE_HOME": None,
    "JUPYTERLAB_SETTINGS_DIR": None,
    "JUPYTERLAB_WORKSPACES_DIR": None,
    "JUPYTER_RUNTIME_DIR": None,
    "ROS_LOG_DIR": None,
}


def test_lesson_one_begins_and_exercise_one_is_graded(tmp_path: Path) -> None:
    spare = tmp_path / "temporary"
    spare.mkdir()
    with learner(tmp_path, **NO_HOME, COURSE_KIT_PROGRESS="", TMPDIR=str(spare)) as someone:
        someone.page.goto(
            f"{someone.address}/lab?token={someone.token}"
        )  # as it is before anybody has arranged anything
        expect(someone.page.locator(".jp-TableOfContents")).to_be_visible()
        expect(someone.page.get_by_text("official Jupyter news")).to_have_count(0)
        someone.open("notebooks/01_services.ipynb")
        for start in ("%load_ext course_kit", "from rclpy.node import Node", "class Display(Node)", "lab.publish("):
            someone.run_cell_that_begins(start)
        someone.require_no_error("notebooks/01_services.ipynb")
        someone.open("exercises/temperature_service/temperature_service.ipynb")
        someone.run_all()
        expect(someone.page.locator(".course-kit-report").last).to_contain_text("not passed")
        log = (tmp_path / "jupyter.log").read_text()
    assert f"it keeps its files below {spare}" in log
    assert "Traceback" not in log
    [state] = spare.glob("ros2-course-kit-*")
    assert (
        json.loads((someone.root.parent / ".course" / "progress.json").read_text())["exercises"]["temperature_service"][
            "tries"
        ]
        == 1
    )
    assert (state / "jupyter" / "ipythondir" / "profile_default").is_dir()

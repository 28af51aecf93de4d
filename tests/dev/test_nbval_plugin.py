"""What nbval compares of a notebook, and which notebooks it runs."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import nbformat
import pytest

from course_kit import environment
from course_kit.dev import suite

ROOT = environment.checkout_folder() or Path()


PICTURE = """import os

class Picture:
    def _repr_mimebundle_(self, **_):
        where = "here" if os.environ["ROS_DOMAIN_ID"] == "{}" else "on a graph that nobody else has"
        return {{"text/html": "<b>measured just now</b>", "text/plain": f"a picture {{where}}"}}

Picture()"""


@pytest.mark.parametrize(("words", "code"), [("a picture on a graph that nobody else has", 0), ("another picture", 1)])
def test_of_a_picture_the_words_are_compared_and_its_html_is_not(words: str, code: int, domain: int) -> None:
    stored = {"text/html": "<b>measured then</b>", "text/plain": words}
    output = nbformat.v4.new_output("execute_result", stored, execution_count=1)
    cell = nbformat.v4.new_code_cell(PICTURE.format(domain), outputs=[output], execution_count=1)
    (ROOT / "artifacts").mkdir(exist_ok=True)  # in the course's folder, whose conftest.py has the settings
    folder = tempfile.TemporaryDirectory(dir=ROOT / "artifacts")
    path = Path(folder.name, "picture.ipynb")
    nbformat.write(nbformat.v4.new_notebook(cells=[cell]), path)
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "--nbval", "-p", "no:cacheprovider", str(path)],
        env=environment.child_environment(ROS_DOMAIN_ID=str(domain)),
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    folder.cleanup()
    assert done.returncode == code, done.stdout


def test_lessons_and_drills_are_compared_and_exercises_are_not() -> None:
    root = environment.checkout_folder() or Path()
    found = {path.relative_to(root).parts[:2] for path in suite.list_with_outputs(root)}
    assert found >= {("notebooks", "01_services.ipynb"), ("exercises", "drills")}
    assert ("exercises", "move_robot") not in found

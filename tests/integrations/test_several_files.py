"""`%%submission EXERCISE FILE`: an answer of several files in one notebook, run and graded there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.learner import progress
from tests import several_files
from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

FILES = several_files.FILES


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    folder = tmp_path_factory.mktemp("kernel")
    several_files.write(folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("COURSE_EXERCISES", str(folder))
        with Kernel(cwd=folder) as running:
            assert running.run("%load_ext course_kit").ok
            yield running


def mark(name: str, text: str = "") -> str:
    return f"%%submission {several_files.ID} {name}\n{text or FILES[name]}"


def test_the_files_run_side_by_side_and_are_graded_together_or_one_alone(kernel: Kernel, tmp_path: Path) -> None:
    kernel.run(f"import os\nos.environ['{progress.VARIABLE}'] = {str(tmp_path / 'progress.json')!r}")
    for name in FILES:
        done = kernel.run(mark(name))
        assert (done.ok, done.stderr) == (True, ""), name  # the parameter file is no Python, and is not run
    assert kernel.run("print(Gate.__name__, __name__)").stdout == "Gate __main__\n"
    assert kernel.run("%ros_launch pair pace:=3.0").ok
    asked = "await lab.get_parameters('/gate', 'reason'), await lab.get_parameters('/guard', 'pace')"
    kernel.run("from course_kit import lab")
    assert kernel.run(asked).result["text/plain"] == "(reason: 'from the file', pace: 3.0)"
    assert kernel.run("%ros_stop pair.launch").ok
    done = kernel.run(f"%grade {several_files.ID}")
    assert "5 of 5 points, passed" in done.result["text/plain"]
    assert done.stdout.startswith("Grading gate.py in In[")
    shown = kernel.run(f"%solution {several_files.ID}").result["text/plain"]
    yours, _, ours = shown.partition("\n\nOurs:\n\n")
    for name, text in FILES.items():
        assert f"%%submission {several_files.ID} {name}\n{text}" in yours
        assert f"# --- {name}\n{text.rstrip()}" in ours
    kernel.run(f"os.environ['{progress.VARIABLE}'] = 'off'")
    kernel.run(mark("guard.py", "import rclpy\n1 / 0"))
    assert "2 of 2 points, gate alone" in kernel.run(f"%grade {several_files.ID} --only gate").result["text/plain"]
    assert "0 of 1 point, guard alone" in kernel.run(f"%grade {several_files.ID} --only guard").result["text/plain"]


@pytest.mark.parametrize("name", ["", "gate.txt", "../gate.py"])
def test_a_file_that_it_cannot_have_is_said(kernel: Kernel, name: str) -> None:
    said = kernel.run(f"%%submission {several_files.ID} {name}\nprint('ran')")
    assert said.stderr.startswith(f"Name the file: %%submission {several_files.ID} FILE. The task asks for gate.py, ")
    assert said.stdout == ""
    alone = kernel.run("%%submission temperature_service gate.py\npass").stderr
    assert alone == "temperature_service is one program: %%submission temperature_service\n"

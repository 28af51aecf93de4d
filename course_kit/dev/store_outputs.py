"""Runs notebooks and stores their outputs, free of everything that would change without meaning anything.

`python -m course_kit.dev.store_outputs notebooks/01_services.ipynb ...`
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

from course_kit import environment
from course_kit.authoring.edition_plan import number_anew
from course_kit.authoring.new_exercise import METADATA
from course_kit.dev import lesson_steps
from course_kit.text.console import refuse

CELL_TIMEOUT_S = 60
WIDGET = "application/vnd.jupyter.widget-view+json"


def store_outputs(path: Path) -> None:
    """Execute one notebook in its own folder, its steps solved, and write it back with its outputs."""
    notebook = nbformat.read(path, as_version=4)
    given = [step.empty.source for step in lesson_steps.steps_of(notebook)]
    steps = lesson_steps.solve_steps(notebook)
    client = NotebookClient(notebook, timeout=CELL_TIMEOUT_S, resources={"metadata": {"path": str(path.parent)}})
    client.execute()
    lesson_steps.empty_steps(steps, given)
    nbformat.write(normalise_notebook(notebook), path)


def normalise_notebook(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """The notebook with times, kernel versions and widget models of this run left out."""
    notebook.metadata = METADATA
    number_anew(notebook)
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        for output in cell.get("outputs", []):
            if "data" in output:  # without a kernel a widget is an error message; its words remain
                output.data.pop(WIDGET, None)
    return notebook


def main(arguments: list[str]) -> int:
    """Run the notebooks named on the command line on their own graph; 2 when there is no domain for it."""
    os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])  # for !ros2
    try:
        with environment.exclusive_domain() as domain_id:
            os.environ["ROS_DOMAIN_ID"] = str(domain_id)
            os.environ["COURSE_KIT_PROGRESS"] = "off"  # the author has passed nothing here
            for name in arguments:
                store_outputs(Path(name))
                print(f"stored {name}")
    except environment.DomainError as problem:
        return refuse(problem)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""`course-kit new exercise`: makes the folder of an exercise, or writes its task anew where learners read it."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit import environment
from course_kit.text.console import cannot

if TYPE_CHECKING:
    import argparse

_KINDS = {
    "service": "an exercise in which a node answers requests",
    "action": "one in which a node reaches goals",
    "parameters": "one in which a node is set by parameters",
    "topic": "one in which a node answers messages with messages",
}


def add_to(verbs: Any) -> None:
    """Add the verb to the command line's parser."""
    parser = verbs.add_parser(
        "new",
        help="make an exercise of your own, in any folder",
        epilog="course_kit/authoring/AUTHORING.md says what to do next.",
    )
    parser.add_argument("what", choices=("exercise",))
    parser.add_argument("name", help="its id: small letters, digits and _")
    kind = parser.add_mutually_exclusive_group(required=True)
    for name, text in _KINDS.items():
        kind.add_argument(f"--{name}", dest="kind", action="store_const", const=name, help=text)
    kind.add_argument(
        "--refresh",
        action="store_true",
        help="write the sentences of its exercise.toml anew into its starter and notebook, and the starter into the "
        "notebook",
    )
    parser.add_argument(
        "--in", dest="folder", type=Path, metavar="DIR", help="the folder its folder is in; where you are if left out"
    )
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Make it and say what to do next; 2 where that cannot be done."""
    from course_kit.grading import GradingError

    try:
        return _refresh(options) if options.refresh else _create(options)
    except GradingError as problem:
        return cannot(str(problem))
    except OSError as problem:
        return cannot(f"{problem.filename or options.name} could not be written: {problem.strerror or problem}.")


def _create(options: argparse.Namespace) -> int:
    from course_kit.authoring import new_exercise
    from course_kit.learner.workspace import shown

    task = new_exercise.create(options.name, options.kind, options.folder or Path.cwd())
    folder, program = (shlex.quote(str(shown(path))) for path in (task.folder, task.solution))
    command = environment.command()
    print(f"The exercise {task.id} is in {folder}. It works as it is:")
    print(f"  {command} grade {task.id} {program} --exercises {folder}")
    print("Change exercise.toml, the starter and the solution into your own exercise; after a change of the task:")
    print(f"  {command} new exercise {task.id} --refresh{_in(options)}")
    print("The guide is course_kit/authoring/AUTHORING.md.")
    return 0


def _refresh(options: argparse.Namespace) -> int:
    from course_kit.authoring import new_exercise
    from course_kit.grading import exercise
    from course_kit.grading.exercise_folders import TOML
    from course_kit.learner.workspace import shown

    folder = (options.folder or Path.cwd()) / options.name
    task = exercise.read(folder) if (folder / TOML).is_file() else exercise.load(options.name)
    changed = new_exercise.refresh(task)
    for path in changed:
        print(shown(path))
    if not changed:
        print(f"The starter and the notebook of {task.id} are as its exercise.toml says.")
    return 0


def _in(options: argparse.Namespace) -> str:
    return "" if options.folder is None else f" --in {shlex.quote(str(options.folder))}"

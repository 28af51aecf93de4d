"""What a JupyterHub starts for each user: their own folder of lessons, then the hub's own single-user server.

One installation serves all users and belongs to none of them. Files, progress and the ROS domain are those of the Unix
user as whom the hub starts this. `course_kit/guides/jupyterhub.md` is the administrator's guide.
"""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

from course_kit import environment
from course_kit.integrations import jupyter
from course_kit.text.console import cannot, tell

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

VERB = "hub-singleuser"
# What the hub tells the servers that it starts (JupyterHub, "Spawners").
_OF_THE_HUB = "JUPYTERHUB_SERVICE_URL"
_ROOT_DIR, _DEFAULT_URL = "JUPYTERHUB_ROOT_DIR", "JUPYTERHUB_DEFAULT_URL"


def run(arguments: Sequence[str]) -> int:
    """Replace this process by a user's server on a hub; return 2 where that cannot be done."""
    if not os.environ.get(_OF_THE_HUB):
        return cannot(
            f"only a JupyterHub can start {VERB}, as its c.Spawner.cmd. To open the course yourself, run "
            f"{environment.command()} lab."
        )
    if find_spec("jupyterhub") is None:
        return cannot(
            f"JupyterHub is not installed in the course's environment. In the course's folder, its owner runs: "
            f'{sys.executable} -m pip install -e ".[hub]"'
        )
    root = environment.course_files()
    if root is None:
        return cannot("the lessons are missing in this installation. Install the course again.")
    try:
        as_root = jupyter.root_arguments(arguments, os.geteuid(), environment.paths.sign_of_container(), VERB)
    except jupyter.LabStartError as problem:
        return cannot(problem)
    folder = environment.paths.usual_learner_folder()
    lesson = jupyter.FIRST_LESSON
    try:
        jupyter.make_ready(root, folder)
    except jupyter.LabStartError as problem:  # the server starts without the lessons
        tell(problem)
        lesson = ""
    command, environ = server_command(folder, lesson, [*as_root, *arguments])
    sys.stdout.flush()
    return os.execve(sys.executable, command, environ)


def server_command(folder: Path, lesson: str, arguments: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """The words and the environment that start a user's server."""
    variables = jupyter.server_variables(folder)
    try:
        environ = environment.child_environment(**variables)
    except environment.DomainError as problem:
        tell(problem)  # the notebooks will look for one again, and say so, too
        environ = {**os.environ, **variables}
    root, opens = shown(folder, lesson, environ)
    environ.setdefault(_DEFAULT_URL, opens)  # what the administrator has set counts
    tell(environment.middleware.unsupported())
    command = environment.trusted_python("jupyterhub.singleuser", "main")
    return [*command, *jupyter.server_options(root), *arguments], environ


def shown(folder: Path, lesson: str, environ: Mapping[str, str]) -> tuple[Path, str]:
    """The folder that the server shows, and the address it opens."""
    chosen = environ.get(_ROOT_DIR)
    root = Path(chosen).expanduser() if chosen else folder
    if not lesson:
        return (root if root.is_dir() else Path.home()), "/lab"
    if not folder.is_relative_to(root):
        tell(f"c.Spawner.notebook_dir is {root}, and the lessons are in {folder}: the server shows that instead.")
        root = folder
    return root, f"/lab/tree/{quote((folder / lesson).relative_to(root).as_posix())}"

"""Starts JupyterLab on the course, on this machine as it is: shared folders, root, a hub.

A JupyterHub starts for each user their own folder of lessons, then its own single-user server;
`course_kit/guides/jupyterhub.md` is the administrator's guide.
"""

from __future__ import annotations

import json
import os
import sys
import webbrowser
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from jupyter_core import paths

from course_kit import environment
from course_kit.grading.errors import GradingError
from course_kit.grading.model import exercise_folders
from course_kit.interfaces.sources import PATH_VARIABLE
from course_kit.learner import course_list, workspace
from course_kit.text.console import note, refuse

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

FIRST_LESSON = "notebooks/00_welcome.ipynb"
PROGRESS_PAGE = "progress.md"  # the first thing on a learner's second day
_CONFIG_PATH, _WORKSPACES = "JUPYTER_CONFIG_PATH", "JUPYTERLAB_WORKSPACES_DIR"
_CONFIG = environment.PACKAGE / "jupyter_config"  # with labconfig: what JupyterLab asks at its first start is answered
_SHOW_PANELS = "--LabApp.expose_app_in_browser=True"  # they ask it for their own view beside the notebook
_ALLOW_ROOT, _NO_BROWSER = "--allow-root", "--no-browser"
HUB_VERB = "hub-singleuser"
_LAYOUT = "layout-restorer:data"  # of a workspace: what stands where in the window
# What a JupyterHub tells the servers that it starts (JupyterHub, "Spawners").
_OF_THE_HUB = "JUPYTERHUB_SERVICE_URL"
_ROOT_DIR, _DEFAULT_URL = "JUPYTERHUB_ROOT_DIR", "JUPYTERHUB_DEFAULT_URL"


class LabStartError(GradingError):
    """JupyterLab cannot be started here; the text is for the user."""


def run_lab(arguments: Sequence[str]) -> int:
    """Replace this process by JupyterLab, opened where the learner left it; return 2 where that cannot be done."""
    root = environment.course_files()
    if root is None:
        return refuse("the lessons are missing in this installation. Install the course again.")
    usual = environment.paths.usual_learner_folder()
    folder = environment.learner_folder() or usual
    if arguments and not arguments[0].startswith("-"):
        named, *arguments = arguments
        folder = Path(named).resolve()
        if folder.is_file() or (root in folder.parents and folder != usual):
            return refuse(f"{folder} cannot be your folder. Leave it out, or name a folder outside of {root}.")
    if set(arguments) <= {_NO_BROWSER, _ALLOW_ROOT} and (address := running_server(folder)):
        # A second one would bring its own kernels and save over the files of the first.
        print(f"JupyterLab is already running for {folder}: {address}")
        if _NO_BROWSER not in arguments:
            webbrowser.open(address)
        return 0
    last = last_notebook(folder)
    opens = (
        PROGRESS_PAGE if (page := course_list.format_progress_page(folder, last)) and folder.resolve() != root else last
    )
    command, environ = lab_command(folder, f"/lab/tree/{quote(opens)}", arguments)
    make_ready(root, folder)  # only where JupyterLab can start
    if opens == PROGRESS_PAGE:
        environment.write_atomically(folder / PROGRESS_PAGE, page)
    sys.stdout.flush()
    return os.execve(sys.executable, command, environ)


def running_server(folder: Path) -> str:
    """The address of a JupyterLab that shows a folder already, or ""."""
    runtime = Path(paths.jupyter_runtime_dir())
    for file in runtime.glob("jpserver-*.json"):
        with suppress(OSError, ValueError, LookupError, TypeError):  # one that has ended, or another program's file
            server = json.loads(file.read_bytes())
            os.kill(server["pid"], 0)
            if Path(server["root_dir"]) == folder:
                return f"{server['url']}lab" + (f"?token={server['token']}" if server["token"] else "")
    return ""


def run_on_hub(arguments: Sequence[str]) -> int:
    """Replace this process by a user's server on a hub; return 2 where that cannot be done."""
    if not os.environ.get(_OF_THE_HUB):
        return refuse(
            f"only a JupyterHub can start {HUB_VERB}, as its c.Spawner.cmd. To open the course yourself, run "
            f"{environment.course_command()} lab."
        )
    if find_spec("jupyterhub") is None:
        return refuse(
            f"JupyterHub is not installed in the course's environment. In the course's folder, its owner runs: "
            f'{sys.executable} -m pip install -e ".[hub]"'
        )
    root = environment.course_files()
    if root is None:
        return refuse("the lessons are missing in this installation. Install the course again.")
    as_root = root_arguments(arguments, os.geteuid(), environment.paths.sign_of_container(), HUB_VERB)
    folder = environment.paths.usual_learner_folder()
    lesson = last_notebook(folder)
    try:
        make_ready(root, folder)
    except LabStartError as problem:  # the server starts without the lessons
        note(problem)
        lesson = ""
    command, environ = hub_command(folder, lesson, [*as_root, *arguments])
    sys.stdout.flush()
    return os.execve(sys.executable, command, environ)


def hub_command(folder: Path, lesson: str, arguments: Sequence[str]) -> tuple[list[str], dict[str, str]]:
    """The words and the environment that start a user's server."""
    variables = server_variables(folder)
    try:
        environ = environment.child_environment(**variables)
    except environment.DomainError as problem:
        note(problem)  # the notebooks will look for one again, and say so, too
        environ = {**os.environ, **variables}
    root, opens = shown_on_hub(folder, lesson, environ)
    environ.setdefault(_DEFAULT_URL, opens)  # what the administrator has set counts
    note(environment.middleware.explain_middleware())
    command = environment.trusted_python("jupyterhub.singleuser", "main")
    return [*command, f"--ServerApp.root_dir={root}", _SHOW_PANELS, *arguments], environ


def shown_on_hub(folder: Path, lesson: str, environ: Mapping[str, str]) -> tuple[Path, str]:
    """The folder that the server shows, and the address it opens."""
    chosen = environ.get(_ROOT_DIR)
    root = Path(chosen).expanduser() if chosen else folder
    if not lesson:
        return (root if root.is_dir() else Path.home()), "/lab"
    if not folder.is_relative_to(root):
        note(f"c.Spawner.notebook_dir is {root}, and the lessons are in {folder}: the server shows that instead.")
        root = folder
    return root, f"/lab/tree/{quote((folder / lesson).relative_to(root).as_posix())}"


def lab_command(
    root: Path, opens: str, arguments: Sequence[str], *, verb: str = "lab", **variables: str
) -> tuple[list[str], dict[str, str]]:
    """The words and the environment that start JupyterLab here."""
    as_root = root_arguments(arguments, os.geteuid(), environment.paths.sign_of_container(), verb)
    environ = environment.child_environment(**{**server_variables(root), **variables})
    environ[_CONFIG_PATH] += f"{os.pathsep}{_CONFIG / 'alone'}"  # nbgrader's menu is for a hub
    note(environment.middleware.explain_middleware())
    command = [
        *environment.trusted_python("jupyterlab.labapp", "main"),
        f"--ServerApp.root_dir={root}",
        _SHOW_PANELS,
        f"--LabApp.default_url={opens}",
        *as_root,
        *arguments,
    ]
    return command, environ


def server_variables(folder: Path) -> dict[str, str]:
    """What its environment has beside the settings of ROS."""
    found = {environment.paths.FOLDER_VARIABLE: str(folder)}
    if path := exercise_folders.interface_path():  # by which programs in terminals find the types that exercises bring
        found[PATH_VARIABLE] = path
    before = os.environ.get(_CONFIG_PATH)
    found[_CONFIG_PATH] = os.pathsep.join(filter(None, (before, str(_CONFIG))))
    found[_WORKSPACES] = os.environ.get(_WORKSPACES) or str(_workspaces(folder))
    return found


def root_arguments(arguments: Sequence[str], user: int, container: str, verb: str = "lab") -> list[str]:
    """What `jupyter lab` needs beside the user's arguments to start as root, which it refuses by itself."""
    if user != 0 or any("allow-root" in word or "allow_root" in word for word in arguments):
        return []
    if container:
        note(f"you are root in a container ({container}), so JupyterLab is started with {_ALLOW_ROOT}.")
        return [_ALLOW_ROOT]
    raise LabStartError(
        "JupyterLab does not run as root: a program in a notebook could change anything on this machine. Log in as an "
        f"ordinary user, or add {_ALLOW_ROOT} if you mean it: {environment.course_command()} {verb} {_ALLOW_ROOT}"
    )


def make_ready(root: Path, folder: Path) -> None:
    """Bring a learner's folder up to date; the course's own folder, which an author opens, stays as it is."""
    if folder.resolve() == root:
        return
    try:
        is_new = not folder.exists()
        workspace.make_copy(root, folder)
    except OSError as problem:
        what = f"{problem.filename or folder} could not be written: {problem.strerror or problem}"
        raise LabStartError(f"Your folder for the lessons could not be made: {what}.") from problem
    prepare_workspace(_workspaces(folder))
    if environment.checkout_folder() is not None and environment.paths.is_shared(root):
        note(f"{root} is read-only for you, so JupyterLab opens your copy: {folder}. Your changes there are kept.")
    elif is_new:
        note(f"Your lessons and exercises are in {folder}. What you change there is kept when the course is updated.")


def _workspaces(folder: Path) -> Path:
    """Where JupyterLab keeps how a learner's window looked: with the folder, so that another one's tabs stay there."""
    return folder / ".course" / "workspaces"


def _load_workspace(workspaces: Path) -> tuple[Path | None, dict[str, Any]]:
    """The file in which JupyterLab has kept how its window looked, and what is in it; nothing before the first time."""
    with suppress(OSError, ValueError):
        for file in workspaces.glob("default-*"):
            content = json.loads(file.read_bytes())
            if isinstance(content, dict) and isinstance(content.get("data"), dict):
                return file, content
    return None, {"data": {}}


def last_notebook(folder: Path) -> str:
    """The notebook that the learner had before them when they left; the first lesson before that."""
    data: dict[str, Any] = _load_workspace(_workspaces(folder))[1]["data"]
    with suppress(LookupError, TypeError):
        front = str(data[_LAYOUT]["main"]["current"])
        for name in (front, *reversed(data)):
            kind, _, path = str(name).partition(":")
            if kind == "notebook" and (folder / path).is_file():
                return path
    return FIRST_LESSON


def prepare_workspace(workspaces: Path) -> None:
    """Write the first workspace of a folder; close what is open in a later one: each notebook would start a kernel."""
    first = (_CONFIG / "workspace.json").read_text(encoding="utf-8")
    file, content = _load_workspace(workspaces)
    with suppress(OSError, LookupError, TypeError):  # where that fails, Jupyter's own default counts
        if file is None:
            from jupyterlab_server.workspaces_handler import WorkspacesManager  # takes half a second

            workspaces.mkdir(parents=True, exist_ok=True)
            WorkspacesManager(str(workspaces)).save("default", first)
            return
        data = content["data"]
        layout = {**data[_LAYOUT], "main": json.loads(first)["data"][_LAYOUT]["main"]}
        values = {name: value for name, value in data.items() if name.startswith("file-browser")}
        content["data"] = {**values, _LAYOUT: layout}
        environment.write_atomically(file, json.dumps(content))

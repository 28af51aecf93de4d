"""One presentation, from its folder to the end of its JupyterLab; port, ROS domain and workspace are its own."""

from __future__ import annotations

import signal
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.integrations import jupyter
from course_kit.presentation import preparing, web
from course_kit.presentation.preparing import PresentationError
from course_kit.process.child import Child

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_ENDING = (signal.SIGTERM, signal.SIGHUP)  # a shutdown, and a terminal that is closed
_SHUTDOWN_S = 20.0  # Jupyter ends its kernels first


def present_notebook(root: Path, name: str, arguments: Sequence[str]) -> int:
    """Show a notebook to a class until it is over."""
    opened = preparing.find_notebook(root, name)
    for number in _ENDING:
        signal.signal(number, _end)
    with _own_domain() as domain_id:
        try:
            with tempfile.TemporaryDirectory(prefix="course-present-", ignore_cleanup_errors=True) as made:
                preparing.prepare_folder(root, Path(made), opened)
                return _serve(Path(made), opened.relative_to(root).as_posix(), domain_id, arguments)
        except KeyboardInterrupt:
            return 0
        except OSError as problem:
            what = f"{problem.filename or tempfile.gettempdir()}: {problem.strerror or problem}"
            raise PresentationError(f"The copies for the class could not be made ({what}).") from problem


def _serve(folder: Path, notebook: str, domain_id: str, arguments: Sequence[str]) -> int:
    settings = folder / preparing.SETTINGS
    opens = f"/doc/tree/{notebook}"
    command, environ = jupyter.lab_command(
        folder / preparing.FILES,
        opens,
        [
            f"--LabApp.extra_labextensions_path={preparing.LABEXTENSIONS}",
            f"--ServerApp.jpserver_extensions={web.__name__}=True",
            "--Application.log_level=ERROR",
            *arguments,
        ],
        verb="present",
        ROS_DOMAIN_ID=domain_id,
        JUPYTERLAB_SETTINGS_DIR=str(settings),
        JUPYTERLAB_WORKSPACES_DIR=str(settings / "workspaces"),
        JUPYTER_RUNTIME_DIR=str(folder / "runtime"),
        **{web.FOLDER_VARIABLE: str(folder), web.OPENS_VARIABLE: opens},
    )
    server = Child(command, environ=environ, dies_with_us=True)
    try:
        return 2 if server.wait() else 0
    finally:
        server.send(signal.SIGTERM)  # after SIGINT it would show where it was while it starts
        server.wait_or_kill(_SHUTDOWN_S)
        server.kill()  # what it has left behind


@contextmanager
def _own_domain() -> Iterator[str]:
    """A domain for this presentation alone, or the one that the user has chosen."""
    chosen = environment.domain_of_user()
    if chosen is not None:
        yield str(chosen)
        return
    with environment.exclusive_domain() as domain_id:
        yield str(domain_id)


def _end(number: int, _frame: object) -> None:
    for other in (*_ENDING, signal.SIGINT):
        signal.signal(other, signal.SIG_IGN)  # a second one would disturb the tidying up
    raise SystemExit(128 + number)

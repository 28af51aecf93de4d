"""An extension of Jupyter Server: terminals and kernels of any server in this environment find `ros2`.

Terminals complete `ros2` with Tab, and notebooks are exported as `export` says.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jupyter_server.serverapp import ServerApp
    from traitlets.config import Config

START_FILE = Path(__file__).with_name("terminal.bash")  # a login shell's own files set PATH anew: it comes after them
_SCRIPTS = "COURSE_KIT_SCRIPTS"  # what the start file reads
_LIKE_BASH = ("", "sh", "bash", "dash")  # whose users are at home in bash
_EXPORTS = Path(__file__).parents[1] / "jupyter_config" / "jupyter_nbconvert_config.json"


def _jupyter_server_extension_points() -> list[dict[str, str]]:
    """Asked by Jupyter Server for what there is to load."""
    return [{"module": __name__}]


def _link_jupyter_server_extension(server: ServerApp) -> None:
    """Called before any extension is loaded, so before the one that starts terminals reads its settings."""
    environment.paths.put_scripts_first()
    os.environ[_SCRIPTS] = str(environment.paths.scripts_folder())
    set_exports(server.config)
    settings, bash = server.terminado_settings, shutil.which("bash")
    if "shell_command" in settings or bash is None or not prefers_bash():
        return
    command = [bash, "--rcfile", str(START_FILE)]
    if not sys.stdout.isatty():  # as Jupyter Server decides it: who starts it so, as a hub does, has not logged in
        command = [bash, "-l", "-c", 'exec "$0" --rcfile "$1"', bash, str(START_FILE)]
    server.terminado_settings = {**settings, "shell_command": command}


def prefers_bash(environ: Mapping[str, str] = os.environ) -> bool:
    """Whether terminals are bash, which completes `ros2`: those of the course's own server, else by SHELL."""
    return environment.paths.FOLDER_VARIABLE in environ or Path(environ.get("SHELL", "")).name in _LIKE_BASH


def set_exports(config: Config) -> None:
    """Have a server export as `jupyter nbconvert` does here; what the user has set counts."""
    from traitlets.config import Config

    exports = Config(json.loads(_EXPORTS.read_text(encoding="utf-8")))
    exports.merge(config)
    config.update(exports)


def _load_jupyter_server_extension(server: ServerApp) -> None:
    """Called when it is loaded: give the page what a notebook's questions were answered with (see labextension)."""
    from jupyter_server.base.handlers import APIHandler
    from jupyter_server.utils import url_path_join
    from tornado import web

    class Guesses(APIHandler):  # type: ignore[misc, unused-ignore]
        @web.authenticated  # type: ignore[untyped-decorator, unused-ignore]
        def get(self) -> None:
            from course_kit.quiz import guesses

            self.finish(guesses.chosen_answers())

    address = url_path_join(server.base_url, "course-kit/guesses")
    server.web_app.add_handlers(".*$", [(address, Guesses)])  # type: ignore[no-untyped-call, unused-ignore]

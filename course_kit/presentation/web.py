"""An extension of a presentation's Jupyter server: it serves the speaker's window, and says where both pages are."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jupyter_server.base.handlers import JupyterHandler
from jupyter_server.utils import url_path_join
from tornado import web

from course_kit.presentation.preparing import SPEAKER_PAGE
from course_kit.text.console import note

if TYPE_CHECKING:
    from jupyter_server.serverapp import ServerApp

FOLDER_VARIABLE, OPENS_VARIABLE = "COURSE_KIT_PRESENTATION", "COURSE_KIT_PRESENTATION_OPENS"
SPEAKER_ADDRESS = "course-kit/speaker"


class SpeakerHandler(JupyterHandler):
    """The speaker's window, for whoever has logged in or has the token."""

    @web.authenticated
    def get(self) -> Any:
        """Answer with the page that was made when the presentation began."""
        self.set_header("Content-Type", "text/html; charset=UTF-8")
        self.set_header("Cache-Control", "no-store")
        return self.finish(Path(os.environ[FOLDER_VARIABLE], SPEAKER_PAGE).read_text(encoding="utf-8"))


def _jupyter_server_extension_points() -> list[dict[str, str]]:
    """Asked by Jupyter Server for what there is to load."""
    return [{"module": __name__}]


def _load_jupyter_server_extension(server: ServerApp) -> None:
    """Called when it is loaded, before the server has a port."""
    base = server.web_app.settings["base_url"]
    handlers = [(url_path_join(base, SPEAKER_ADDRESS), SpeakerHandler)]
    server.web_app.add_handlers(".*$", handlers)  # type: ignore[no-untyped-call]
    server.io_loop.add_callback(_say_where, server)


def _say_where(server: ServerApp) -> None:
    token = server.identity_provider.token
    key = f"?token={token}" if token and not server.password else ""
    note(f"the class sees   {server.connection_url}{os.environ[OPENS_VARIABLE].lstrip('/')}{key}")
    note(f"your notes are   {server.connection_url}{SPEAKER_ADDRESS}{key}   (Alt+S on the projected page, too)")
    note("Ctrl-C ends the presentation and removes its copies.")

"""A real JupyterLab server, what its REST interface says, and a terminal in it."""

from __future__ import annotations

import json
import os
import re
import secrets
import signal
import subprocess
import time
import urllib.request
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import websocket  # Jupyter Server brings it

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

PATIENCE_S = 240.0  # against hanging only
_STEERING = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]|\x1b\][^\x07]*\x07|\r")


@dataclass(frozen=True)
class Server:
    """A running one."""

    address: str
    token: str
    log: Path

    def get(self, path: str) -> Any:
        """What `/api/...` answers."""
        return self._ask(path)

    def post(self, path: str) -> Any:
        """What it answers to a request to make something."""
        return self._ask(path, "POST")

    def delete(self, path: str) -> None:
        """Ask it to end something."""
        self._ask(path, "DELETE")

    def _ask(self, path: str, method: str = "GET") -> Any:
        request = urllib.request.Request(  # noqa: S310 - an http address of this machine
            f"{self.address}/api/{path}", method=method, headers={"Authorization": f"token {self.token}"}
        )
        with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:  # noqa: S310
            said = answer.read()
            return json.loads(said) if said else None

    def in_terminal(self, line: str) -> str:
        """Type a line into a new terminal; what it prints until it has ended."""
        name = self.post("terminals")["name"]
        address = self.address.replace("http", "ws", 1)
        connection = websocket.create_connection(
            f"{address}/terminals/websocket/{name}?token={self.token}", timeout=PATIENCE_S
        )
        try:
            # Written apart here, so that only the shell's own output holds the words as they are.
            connection.send(json.dumps(["stdin", f"echo beg''in; {line}; echo e''nd\r"]))
            seen = ""
            while not (found := re.search(r"^begin$(.*)^end$", seen, re.DOTALL | re.MULTILINE)):
                kind, text = json.loads(connection.recv())
                seen += _STEERING.sub("", text) if kind == "stdout" else ""
        finally:
            connection.close()
        return found[1].strip()


@contextmanager
def started(
    command: Sequence[str | Path], folder: Path, cwd: Path, environ: Mapping[str, str | None]
) -> Iterator[Server]:
    """Start a server, wait until it is up, and end it as closing the terminal does.

    Args:
        command: to which the port and the like are added.
        folder: where its log is written.
        cwd: where it is started.
        environ: its environment; what is None is left out.
    """
    port = secrets.choice(range(20_000, 32_000))  # the system gives kernels of others only higher ones
    token, log = secrets.token_hex(16), folder / "jupyter.log"
    with log.open("w") as written:
        process = subprocess.Popen(
            [*command, "--no-browser", f"--port={port}", f"--IdentityProvider.token={token}"],
            cwd=cwd,
            env={name: value for name, value in environ.items() if value is not None},
            stdin=subprocess.DEVNULL,
            stdout=written,
            stderr=written,
            start_new_session=True,
        )
        try:
            address = f"http://127.0.0.1:{port}"
            wait_until_up(f"{address}/api/status?token={token}", process, log)
            yield Server(address, token, log)
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
            process.wait(200)


def allow_root() -> list[str]:
    """What root has to add to `./course lab`, which adds it itself in a container."""
    return ["--allow-root"] if os.geteuid() == 0 and not environment.paths.sign_of_container() else []


def wait_until_up(url: str, process: subprocess.Popen[bytes], log: Path) -> None:
    """Ask for the status until it comes, or the server has ended."""
    deadline = time.monotonic() + PATIENCE_S
    while not is_up(url):
        with suppress(subprocess.TimeoutExpired):
            process.wait(0.2)
        assert process.returncode is None, f"JupyterLab ended:\n{log.read_text()}"
        assert time.monotonic() < deadline, f"JupyterLab did not start:\n{log.read_text()}"


def is_up(url: str) -> bool:
    """Whether something answers there."""
    try:
        with urllib.request.urlopen(url, timeout=200):  # noqa: S310 - an http address of this machine
            return True
    except OSError:
        return False

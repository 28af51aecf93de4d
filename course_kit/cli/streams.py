"""What the command line says and reads, on terminals and in locales of every kind."""

from __future__ import annotations

import io
import json
import os
import re
import sys

_UNUSUAL = re.compile(r"[^ -~\n]")


def read_names_as_utf_8() -> None:
    """Begin again in Python's UTF-8 mode where Python takes names of files for ASCII (LC_ALL=C with PYTHONUTF8=0).

    Those with an umlaut could neither be printed nor written to a report.
    """
    if sys.getfilesystemencoding() == "ascii":
        sys.stdout.flush()
        os.execve(sys.executable, sys.orig_argv, {**os.environ, "PYTHONUTF8": "1"})


def speak_to_any_terminal() -> None:
    """Print a question mark for a character the terminal does not have, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def print_json(document: str) -> None:
    """JSON is UTF-8, whatever the terminal's own encoding.

    What would steer a terminal, or turn the writing round, stands in it as an escape, which means the same.
    """
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    print(_UNUSUAL.sub(_escaped, document))


def _escaped(found: re.Match[str]) -> str:
    return found[0] if found[0].isprintable() else json.dumps(found[0])[1:-1]

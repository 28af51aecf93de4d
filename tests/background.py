"""Commands that run while a test does something, also as a script starts one in the background: Ctrl-C is ignored."""

from __future__ import annotations

import subprocess
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

IN_BACKGROUND = ("sh", "-c", 'trap "" INT; exec "$@"', "sh")


@contextmanager
def started(*command: object, by: Sequence[str] = (), **variables: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(
        [*by, sys.executable, *map(str, command)],
        env=environment.child_environment(PYTHONUNBUFFERED="1", **variables),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
        process.communicate()

"""Makes an environment independent of where it is, so that a course folder can be moved, and an environment copied.

Python itself finds its packages wherever the environment is. Written down in it are only the first lines of its
programs, the way to the course and the scripts that activate it.
"""

from __future__ import annotations

import errno
import os
import re
import shlex
import shutil
import subprocess
from pathlib import Path

from course_setup.problems import SetUpError

PROMPT = "course"
# A shell runs these three lines, and finds Python beside the program; Python sees a string.
_HEAD = b"""#!/bin/sh
'''exec' "$(dirname "$(realpath "$0")")/python" "$0" "$@"
' '''
"""
_PYTHON = rb"/\.venvs?/[^\n]*?python[0-9.]*"
# As pip and uv write them: with a path; or, where it has a space or is long, for the shell.
_WRITTEN = re.compile(rb"#![^\n]*" + _PYTHON + rb"\s*\n|#!/bin/sh\n'''exec' [^\n]*" + _PYTHON + rb"[^\n]*\n' '''\n")
# In `activate`; Pythons before 2025 do not quote the name of a folder.
_PLACE = re.compile(rb"^(\s*(?:export )?VIRTUAL_ENV=)(?!\$\().*$", re.MULTILINE)
# The course's folder is that of `.venvs`; Python reads this file at each start, whatever the locale, so it is ASCII.
_WAY_TO_THE_COURSE = (
    b"import os, sys; sys.path.append(os.path.dirname(os.path.dirname(os.path.realpath(sys.prefix))))\n"
)
# Python's own venv, asked for nothing but those scripts.
_ACTIVATION = """
import sys, venv
builder = venv.EnvBuilder(prompt=sys.argv[2])
builder.setup_scripts(builder.ensure_directories(sys.argv[1]))
"""


def make_portable(environment: Path) -> None:
    """Take the place of an environment out of its programs, and that of the course out of the way to it."""
    for program in (environment / "bin").iterdir():
        if program.is_file() and not program.is_symlink():
            _take_place_out(program)
    activate = environment / "bin" / "activate"
    place = shlex.quote(str(environment)).encode()
    replace(activate, _PLACE.sub(lambda found: found[1] + place, activate.read_bytes()))
    for way in environment.glob("lib/python3*/site-packages/*ros2_course_kit.pth"):
        replace(way, _WAY_TO_THE_COURSE)


def adapt(environment: Path) -> None:
    """Make an environment that has been moved or copied whole again, without a network.

    Raises:
        OSError: it cannot be written.
        SetUpError: its Python cannot write the scripts that activate it.
    """
    # Written over, they would change under their other names, too; and uv has more of them than are written anew.
    for pattern in ("[aA]ctivate", "[aA]ctivate.*"):
        for script in (environment / "bin").glob(pattern):
            script.unlink()
    python = environment / "bin" / "python"
    done = subprocess.run([python, "-I", "-S", "-c", _ACTIVATION, environment, PROMPT], check=False)
    if done.returncode:
        raise SetUpError(f"{environment} could not be adapted. Delete {environment.parent}, and run this again.")
    make_portable(environment)


def copy(source: Path, target: Path) -> None:
    """Copy an environment, within a second and without using room: both get the same files, under two names.

    That does no harm, because installers and compilers of Python write new files instead of changing old ones.
    """
    for folder, inner_folders, files in os.walk(source):
        here = target / Path(folder).relative_to(source)
        here.mkdir()
        for name in (*inner_folders, *files):
            path = Path(folder, name)
            if path.is_symlink():
                (here / name).symlink_to(path.readlink())
            elif name in files and not name.startswith(".course-"):
                _link_or_copy(path, here / name)
    adapt(target)


def replace(path: Path, content: bytes) -> None:
    """Write a file: as it was or as it will be, never in between; other names it has keep the old content."""
    fresh = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    fresh.write_bytes(content)
    if path.exists():
        shutil.copymode(path, fresh)
    fresh.replace(path)


def _link_or_copy(source: Path, target: Path) -> None:
    try:
        target.hardlink_to(source)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT):
            raise
        shutil.copy2(source, target)  # somebody else's file, or a file system without such names


def _take_place_out(program: Path) -> None:
    content = program.read_bytes()
    found = _WRITTEN.match(content)
    if found:
        replace(program, _HEAD + content[found.end() :])

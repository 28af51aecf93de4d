"""`course-kit dev hub`: the course on a real JupyterHub, with its proxy, three Unix users and a Chromium.

It installs the course anew by the commands of the administrator's guide, which may take some minutes, and makes users
who are removed afterwards. What the machine lacks for that is named.
"""

from __future__ import annotations

import argparse
import os
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.dev import browser, suite
from course_kit.text.console import cannot

if TYPE_CHECKING:
    from collections.abc import Sequence

_TESTS = "tests/hub/three_users.py"
_PYTHON = "/usr/bin/python3"  # the guide's: users cannot start one in somebody's home directory
_NEEDED = {"npm": "npm", "useradd": "passwd", "git": "git"}  # a program, and Debian's package for it


def main(arguments: Sequence[str]) -> int:
    """Run the command; 0 when all went well, 1 when something has failed, 2 when it cannot be run."""
    parser = argparse.ArgumentParser(prog="course-kit dev hub", description="Try the course on a real JupyterHub.")
    parser.parse_args(arguments)
    root = environment.checkout()
    if root is None or not (root / _TESTS).is_file():
        return cannot("this belongs to the course's folder; run it in a clone of it.")
    if missing := lacking(os.geteuid()):
        return cannot(f"a JupyterHub cannot be tried here: {'; '.join(missing)}.")
    os.chdir(root)
    environ = environment.child_environment(COURSE_BROWSER=browser.find(), COURSE_KIT_PROGRESS="off")
    return 1 if suite.pytest(["-v", _TESTS], environ) else 0


def lacking(user: int) -> list[str]:
    """What this machine does not have for it, for people.

    Args:
        user: the number of the user who runs it; a hub starts servers as other users, so it has to be root.
    """
    missing = [] if user == 0 else ["only root can run it"]
    for program, package in _NEEDED.items():
        if shutil.which(program) is None:
            missing.append(f"there is no {program} (Debian, Ubuntu: apt install {package})")
    if not Path(_PYTHON).exists():
        missing.append(f"there is no {_PYTHON}")
    if browser.find() is None:
        missing.append("there is no Chromium (Debian, Ubuntu: apt install chromium)")
    return missing

"""Finds, and where it may installs, the Chromium that the browser tests drive."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def find() -> str | None:
    """The path of a Chromium on this machine, or None. COURSE_BROWSER wins."""
    names = (os.environ["COURSE_BROWSER"],) if os.environ.get("COURSE_BROWSER") else NAMES
    return next((path for name in names if (path := shutil.which(name))), None)


def find_or_install() -> str | None:
    """Like `find`, but a machine where we are root and apt-get is at hand gets Debian's Chromium first."""
    path = find()
    if path or os.geteuid() != 0 or not shutil.which("apt-get"):
        return path
    print("course: installing Chromium for the browser tests (apt-get)", file=sys.stderr)
    environ = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for command in (
        ["apt-get", "update", "-qq"],
        ["apt-get", "install", "-y", "-qq", "--no-install-recommends", "chromium"],
    ):
        done = subprocess.run(command, env=environ, stdout=subprocess.DEVNULL, check=False)
        if done.returncode:
            break
    return find()

"""Live and compiled types in two processes: topics, services and actions, each way round."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.interfaces import known_types

PEER = Path(__file__).with_name("peer.py")
REPOSITORY = PEER.parents[2]


@pytest.fixture(scope="module")
def definitions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copies of the texts of two installed packages."""
    folder = tmp_path_factory.mktemp("definitions")
    for package in ("std_srvs", "test_msgs"):
        for prefix in known_types.package_prefixes():
            for kind in ("msg", "srv", "action"):
                source = Path(prefix, "share", package, kind)
                if source.is_dir():
                    shutil.copytree(source, folder / package / kind, ignore=shutil.ignore_patterns("*.idl", "*.json"))
    return folder


def start(role: str, how: str, folder: Path) -> subprocess.Popen[str]:
    search = os.pathsep.join([str(REPOSITORY), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen(
        [sys.executable, str(PEER), role, how, str(folder)],
        env=environment.child_environment(PYTHONPATH=search),
        stdin=subprocess.PIPE,  # closing it ends the server
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


@pytest.mark.parametrize(("server", "client"), [("compiled", "live"), ("live", "compiled"), ("live", "live")])
@pytest.mark.usefixtures("domain")
def test_two_processes_understand_each_other(server: str, client: str, definitions: Path) -> None:
    with start("server", server, definitions) as serving, start("client", client, definitions) as asking:
        try:
            output = asking.communicate(timeout=80)[0]
            output += serving.communicate(timeout=20)[0]
        finally:
            asking.kill()
            serving.kill()
    assert (asking.returncode, serving.returncode) == (0, 0), output
    assert "WARN" not in output

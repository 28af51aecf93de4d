"""Live types against really compiled ones of the same text, built here with g++ from the wheels' own generators.

The other tests compare with what the wheels have compiled; this one covers definitions of our own choice. It is not
collected where a build is impossible (see conftest.py), rather than skipped: a skip would look like an open matter on
the machines of learners, who need no compiler and miss nothing.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from course_kit import environment, interfaces
from tests.interfaces.reference_build import Build
from tests.interfaces.reference_facts import NAMES, PACKAGE, facts_of_package

FACTS = Path(__file__).with_name("reference_facts.py")
BUILDER = Path(__file__).with_name("reference_build.py")
TEXTS = {
    "msg/Waypoint": """# A place on the way.
uint8 KIND_STOP=0
uint8 KIND_PASS=1
string FRAME=map
float64 FACTOR=0.25
bool FLAG=true
uint8 kind 1
string label "wp"
geometry_msgs/Pose pose
float32[3] tolerance [0.1, 0.2, 0.3]
string<=8 brief
wstring wide
wstring<=5[] wides
wstring<=5[2] wide_pair
byte raw
char c
bool[] flags
byte[<=4] blob
string[2] pair
int64[<=3] bounded
uint16[] numbers [1, 65535]
""",
    "msg/Nothing": "",
    "srv/Plan": "std_msgs/Header header\ngeometry_msgs/Pose[] points\nWaypoint wp\n---\nfloat64[] costs\n",
    "srv/Poke": "---\n",
    "action/Navigate": """geometry_msgs/Pose target
Waypoint[] via
builtin_interfaces/Duration timeout
---
bool success
string message
---
geometry_msgs/PoseStamped current
float32 remaining
""",
}


@pytest.fixture(scope="module")
def built(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Build:
    """The package, built once and kept in pytest's cache: it takes a quarter of a minute."""
    texts = tmp_path_factory.mktemp("texts")
    for name, text in TEXTS.items():
        path = texts / f"{name}.{name.split('/')[0]}"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    assert request.config.cache is not None
    target = request.config.cache.mkdir("reference_interfaces") / build_key()
    build = Build(PACKAGE, texts, target)
    if not (target / "complete").exists():
        build.run()
        (target / "complete").touch()
    return build


def build_key() -> str:
    """Changes with all a build depends on."""
    what = [repr(TEXTS), sys.version, sys.prefix, np.__version__, Path(BUILDER).read_text()]
    return hashlib.sha256("".join(what).encode()).hexdigest()[:16]


@pytest.fixture
def live(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> dict[str, Any]:
    monkeypatch.setattr(environment, "run_dir", lambda: tmp_path)
    for name, text in TEXTS.items():
        interfaces.define(f"{PACKAGE}/{name}", text)
    facts: dict[str, Any] = json.loads(json.dumps(facts_of_package()))
    return facts


@pytest.mark.timeout(300)
def test_all_that_can_be_observed_is_equal(built: Build, live: dict[str, Any]) -> None:
    libraries = os.pathsep.join([str(built.library_path), os.environ.get("LD_LIBRARY_PATH", "")])
    search = os.pathsep.join([str(built.python_path), str(FACTS.parents[2]), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, str(FACTS)],
        env=environment.child_environment(LD_LIBRARY_PATH=libraries, PYTHONPATH=search),
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    compiled = json.loads(done.stdout)
    assert set(live) == set(compiled) == set(NAMES)
    for name in NAMES:
        for what in compiled[name]:
            assert live[name][what] == compiled[name][what], (name, what)

"""Who leaves the graph while a discovery callback runs waits for its end."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit.environment import leaving

if TYPE_CHECKING:
    import pytest

PROGRAM = Path(__file__).with_name("leave_amid_a_callback.py")


def test_who_leaves_waits_for_a_discovery_callback(domain: int) -> None:
    assert domain
    done = subprocess.run([sys.executable, PROGRAM], capture_output=True, text=True, check=False, timeout=120)
    assert (done.stdout, done.stderr) == ("waits\nleaves\n", "")


def test_without_the_wheels_nothing_is_touched(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    assert not leaving.repair()


def test_where_no_program_may_make_code_nothing_is_touched(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(code: bytes) -> int:
        raise OSError(len(code))

    before = leaving.slot(leaving.opened()).value
    monkeypatch.setattr(leaving, "_executable", refuse)
    assert not leaving.repair()
    assert leaving.slot(leaving.opened()).value == before

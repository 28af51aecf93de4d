"""Which demo a speaker means."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.presentation import preparing

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def root(tmp_path: Path) -> Path:
    names = ("01_services", "02_actions", "demos/01_deadlock", "demos/02_lost_cancel", "demos/10_late_result")
    for name in names:
        path = tmp_path / "notebooks" / f"{name}.ipynb"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return tmp_path


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("", "demos/01_deadlock"),
        ("2", "demos/02_lost_cancel"),
        ("02", "demos/02_lost_cancel"),
        ("10", "demos/10_late_result"),
        ("lost_cancel", "demos/02_lost_cancel"),
        ("lost-cancel", "demos/02_lost_cancel"),
        ("Deadlock", "demos/01_deadlock"),
        ("dead", "demos/01_deadlock"),
        ("la", "demos/10_late_result"),
        ("cancel", "demos/02_lost_cancel"),
        ("01_deadlock.ipynb", "demos/01_deadlock"),
        ("notebooks/demos/02_lost_cancel.ipynb", "demos/02_lost_cancel"),
        ("services", "01_services"),
        ("02_actions", "02_actions"),
    ],
)
def test_a_number_a_name_a_part_of_it_or_a_path_will_do(root: Path, name: str, meant: str) -> None:
    assert preparing.find_notebook(root, name) == root / "notebooks" / f"{meant}.ipynb"

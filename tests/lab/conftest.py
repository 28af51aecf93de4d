"""A lab of its own for a test, and a real kernel to run cells in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import lab
from course_kit.lab.core import Lab

from tests.lab.kernel import Kernel

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def own_lab(domain: int) -> Iterator[Lab]:
    """A fresh lab on a domain of its own, as the current one."""
    assert domain
    mine = Lab()
    before = lab.use(mine)
    try:
        yield mine
    finally:
        mine.close()
        lab.use(before)


@pytest.fixture
def kernel(domain: int, tmp_path: Path) -> Iterator[Kernel]:
    """A kernel on a domain of its own, with the course's extension loaded."""
    assert domain
    with Kernel(cwd=tmp_path) as running:
        assert running.run("%load_ext course_kit").ok
        yield running

"""The browser tests' one fixture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.learner import learner

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from tests.browser.learner import JupyterLab


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[JupyterLab]:
    """JupyterLab on a copy of the course."""
    with learner(tmp_path, COURSE_KIT_PROGRESS="") as someone:  # kept in the copy
        yield someone

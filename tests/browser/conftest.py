"""The browser tests' one fixture."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.learner import REPOSITORY, JupyterLab, page, served

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def lab(tmp_path: Path) -> Iterator[JupyterLab]:
    """JupyterLab on the course; whatever the test does to the notebooks is undone."""
    notebooks = [*REPOSITORY.glob("notebooks/**/*.ipynb"), *REPOSITORY.glob("exercises/*/*.ipynb")]
    before = {path: path.read_bytes() for path in notebooks}
    try:
        with served(tmp_path) as (address, token), page() as opened:
            yield JupyterLab(opened, address, token)
    finally:
        for path, content in before.items():
            if path.read_bytes() != content:
                path.write_bytes(content)

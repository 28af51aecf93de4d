"""What the browser tests share: one JupyterLab for the tests of a file, and a new learner for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.learner import open_server

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.browser.learner import JupyterLab, OpenServer


@pytest.fixture(scope="module")
def jupyter(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OpenServer]:
    """JupyterLab on a copy of the course."""
    with open_server(tmp_path_factory.mktemp("jupyter")) as started:
        yield started


@pytest.fixture
def lab(jupyter: OpenServer) -> Iterator[JupyterLab]:
    """A learner there."""
    with jupyter.learner() as someone:
        yield someone

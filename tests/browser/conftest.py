"""What the browser tests share: one JupyterLab for all of them, and a new learner for each."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from tests.browser.learner import OpenServer, chromium, started_server

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tests.browser.learner import CourseServer, JupyterLab


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[CourseServer]:
    """JupyterLab on a copy of the course, so that tests side by side never see each other's files."""
    with started_server(tmp_path_factory.mktemp("jupyter")) as started:
        yield started


@pytest.fixture(scope="module")
def jupyter(server: CourseServer) -> Iterator[OpenServer]:
    """The same with a Chromium before it, which would be in the way of another file's event loops."""
    with chromium() as started:
        yield OpenServer(server, started)


@pytest.fixture
def lab(jupyter: OpenServer) -> Iterator[JupyterLab]:
    """A learner there."""
    with jupyter.learner() as someone:
        yield someone

"""The command in a domain of its own, for one test or for one module."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from tests.waiting import wait_until

from .commands import GOLDEN, Ros2

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def ros2(tmp_path: Path) -> Iterator[Ros2]:
    with environment.exclusive_domain() as domain, Ros2(domain, tmp_path) as command:
        yield command


@pytest.fixture(scope="module")
def robot(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ros2]:
    """The command, in a domain where the node of the recordings runs."""
    with environment.exclusive_domain() as domain, Ros2(domain, tmp_path_factory.mktemp("robot")) as command:
        command.start(GOLDEN / "demo_node.py", "/robot")
        # Its name is heard of before what it offers: on a busy machine seconds before.
        wait_until(lambda: "servers: 1" in command("action", "info", "/fibonacci").stdout, "its action server")
        wait_until(lambda: "count: 1" in command("topic", "info", "/in").stdout, "its subscription")
        yield command

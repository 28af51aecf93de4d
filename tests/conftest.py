"""Fixtures for all rooms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator

environment.apply()  # before any test module imports rclpy


@pytest.fixture
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A ROS domain nobody else uses, also in ROS_DOMAIN_ID for the processes a test starts."""
    with environment.exclusive_domain() as domain_id:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain_id))
        yield domain_id

"""The warm worker of the tests of grading, for gradings of each exercise."""

from __future__ import annotations

from tests.grading.conftest import worker

__all__ = ["worker"]

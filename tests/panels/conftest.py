"""What tests of panels share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab


@pytest.fixture
def live_lab(own_lab: Lab) -> Lab:
    """A recording lab of its own, in a domain of its own."""
    own_lab.record()
    return own_lab

"""What tests of panels share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.lab.recording import attaching

if TYPE_CHECKING:
    from course_kit.lab.runtime.core import Lab


@pytest.fixture
def live_lab(own_lab: Lab) -> Lab:
    """A recording lab of its own, in a domain of its own."""
    attaching.attach(own_lab)
    return own_lab

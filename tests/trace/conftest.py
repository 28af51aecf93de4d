"""What tests of the recorder share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import trace

if TYPE_CHECKING:
    from course_kit.lab.core import Lab


@pytest.fixture
def recording(own_lab: Lab) -> trace.Recording:
    """The recording of a lab of its own."""
    return trace.attach(own_lab)

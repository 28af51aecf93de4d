"""What tests of the recorder share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from course_kit.lab.recording.events import Recording
    from course_kit.lab.runtime.core import Lab


@pytest.fixture
def recording(own_lab: Lab) -> Recording:
    """The recording of a lab of its own."""
    return own_lab.record()

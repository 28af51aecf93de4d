"""What tests of panels share."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import lab, trace
from course_kit.lab.core import Lab

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def live_lab(domain: int) -> Iterator[Lab]:
    """A recording lab of its own, in a domain of its own."""
    del domain
    own = Lab()
    before = lab.use(own)
    trace.attach()
    yield own
    own.close()
    lab.use(before)

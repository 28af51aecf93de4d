"""A lab for one test."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit import lab
from course_kit.lab.runtime.core import Lab

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def fresh_lab() -> Iterator[Lab]:
    """A lab of its own, as the current one; it ends afterwards, and the one before is back."""
    mine = Lab()
    before = lab.use(mine)
    try:
        yield mine
    finally:
        mine.close()
        lab.use(before)

"""Graders, one module an exercise: each says in `CHECKS` what it checks, and touches no process, file or socket."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from course_kit.grading.checks.evidence import Failed

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def charge_to(breaks: str) -> Iterator[None]:
    """What fails in here costs this check, or the one that proves this sentence, unless it names another one."""
    try:
        yield
    except Failed as failed:
        failed.breaks = failed.breaks or breaks
        raise

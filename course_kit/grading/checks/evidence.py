"""What a check has seen, and its verdicts."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros.graph import Overview
    from course_kit.ros.sequence import Arrow


@dataclass(frozen=True)
class Evidence:
    """What was seen on the wire: what we sent, what should come back, and what came."""

    sent: str = ""
    expected: str = ""
    got: str = ""
    graph: Overview | None = None  # who talks to whom, where that was looked at


class Failed(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check was not passed."""

    def __init__(self, evidence: Evidence, message: str, diagnosis: str | None = None, *, breaks: str = "") -> None:
        super().__init__(message)
        self.evidence = evidence  # what was seen
        self.message = message  # what happened in this case, in one or two sentences for the learner
        self.diagnosis = diagnosis  # a code of the catalogue when the cause is established, else None
        self.breaks = breaks  # the sentence of the exercise that is broken, where the check proves several
        self.instead = ""  # the check that it would cost by itself; where that is lost, too, nothing else is to blame
        self.steps: tuple[Arrow, ...] = ()  # what crossed the wire; taken from the record of the check when empty


@contextmanager
def charge_to(breaks: str) -> Iterator[None]:
    """What fails in here breaks this sentence, or costs this check, unless it names another one."""
    try:
        yield
    except Failed as failed:
        failed.breaks = failed.breaks or breaks
        raise


class UnseenError(Failed):
    """What a step was to show was over before the grader could see it: it shows nothing, and proves nothing."""


class NotRun(Exception):  # noqa: N818 - it is a verdict, not an error
    """A check that makes no sense in this grading; the text tells the learner why."""

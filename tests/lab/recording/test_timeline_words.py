"""What a time line's drawing writes beside its bars."""

from __future__ import annotations

import re

from course_kit.lab.recording.events import Event
from course_kit.lab.recording.timeline import Timeline

MILLISECOND = 1_000_000


def drawn(milliseconds: float) -> str:
    """A program whose callback has taken so long."""
    what = {"what": "service", "thread": "MainThread", "ident": 1, "process": 1, "failed": False}
    begun = Event("callback_begun", "/slow", "/slow", "std_srvs/srv/Trigger", what, 1, 0)
    ended = Event("callback_ended", "/slow", "/slow", "std_srvs/srv/Trigger", what, 1, int(milliseconds * MILLISECOND))
    return Timeline([], [begun, ended]).html()


def test_a_long_name_of_a_thread_takes_no_room_from_its_time_line() -> None:
    html = drawn(100.0)
    assert re.search(r'class="ck-lane" x="0"[^>]*>[^<]*main thread<', html)
    bar = re.search(r'<rect x="(\d+)"[^>]*width="(\d+)"', html)
    assert bar is not None
    assert (int(bar[1]), int(bar[2])) == (1, 540)

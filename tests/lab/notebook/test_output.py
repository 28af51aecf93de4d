"""The queue of what callbacks print."""

from __future__ import annotations

import io
import threading
from contextlib import redirect_stdout
from typing import TYPE_CHECKING

from course_kit.lab.notebook import output as output_module
from course_kit.lab.notebook.output import Output

if TYPE_CHECKING:
    import pytest


class SlowPage(io.StringIO):
    """Stands in for a notebook's output that takes a line only when it is allowed to."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.allowed = threading.Event(), threading.Event()

    def write(self, text: str) -> int:
        self.asked.set()
        self.allowed.wait(10)
        return super().write(text)


def test_a_drain_ends_only_when_another_thread_has_written_what_it_took() -> None:
    output, page = Output(), SlowPage()
    output.queued = True
    output.put("a log line\n")
    with redirect_stdout(page):
        other = threading.Thread(target=output.drain)
        other.start()
        assert page.asked.wait(10)
        second = threading.Thread(target=output.drain)
        second.start()
        second.join(0.1)
        early = not second.is_alive()
        page.allowed.set()
        second.join(10)
        collected = page.getvalue()
        other.join(10)
    assert not early
    assert collected == "a log line\n"


def test_a_print_that_drains_does_not_wait_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(output_module, "_PATIENCE", 60.0)
    output = Output()
    output.queued = True
    output.pumps.append(output.drain)
    output.put("once\n")
    with redirect_stdout(io.StringIO()) as page:
        thread = threading.Thread(target=output.drain)
        thread.start()
        thread.join(30)
        assert not thread.is_alive()
    assert page.getvalue() == "once\n"

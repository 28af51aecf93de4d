"""Dumps of what the threads of a submission do: whole ones, and what is made of one that never came."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.diagnosis.tracebacks import read_activity
from course_kit.grading.sandbox.output_collector import BoundedOutput, OutputCollector
from course_kit.grading.sandbox.start_order import Streams

if TYPE_CHECKING:
    from collections.abc import Iterator

WORKER = b'Thread 0x00007f02 (most recent call first):\n  File "rclpy/client.py", line 7 in wait\n\n'
MAIN = b'Current thread 0x00007f01 (most recent call first):\n  File "answer.py", line 4 in main\n'


@pytest.fixture
def written() -> Iterator[tuple[OutputCollector, int]]:
    """A process, and the end of the pipe into which its program's dumps go."""
    reader, writer = os.pipe()
    os.set_blocking(reader, False)
    idle = [os.open(os.devnull, os.O_RDONLY) for _ in range(4)]
    streams = Streams(idle[0], idle[1], idle[2], reader, idle[3])
    yield OutputCollector(streams, (BoundedOutput(), BoundedOutput())), writer
    os.close(writer)
    streams.close()


def test_a_dump_is_whole_when_the_next_one_has_begun(written: tuple[OutputCollector, int]) -> None:
    process, writer = written
    for part in (WORKER, MAIN):
        os.write(writer, part)
        process.take("evidence")
        assert not process.has_whole_dump()
    os.write(writer, WORKER)
    process.take("evidence")
    assert process.has_whole_dump()
    assert process.stacks() == (WORKER + MAIN).decode()


def test_a_note_of_the_program_is_no_dump(written: tuple[OutputCollector, int]) -> None:
    process, writer = written
    os.write(writer, b'{"note": {"returned": "Thread 0x1"}}\n')
    process.take("evidence")
    assert not process.has_whole_dump()
    assert not read_activity(process.stacks(), ("answer.py",)).known


def test_forgetting_starts_anew(written: tuple[OutputCollector, int]) -> None:
    process, writer = written
    os.write(writer, WORKER + MAIN + WORKER)
    process.take("evidence")
    process.forget_stacks()
    assert not process.has_whole_dump()
    os.write(writer, MAIN)
    process.take("evidence")
    assert process.stacks() == MAIN.decode()


def test_what_ends_in_the_same_moment_as_the_program_is_read(written: tuple[OutputCollector, int]) -> None:
    process, _ = written
    os.dup2(process.streams.status, process.streams.evidence)
    for name in process.open_streams().values():  # as poll() names them, all at once
        process.take(name)
    assert process.over

"""Messages between the grader's processes."""

from __future__ import annotations

import os
import select
import threading
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.sandbox import channel as ipc
from course_kit.grading.sandbox.channel import Channel, ChannelClosedError

if TYPE_CHECKING:
    import socket


def test_messages_arrive_whole_and_in_order() -> None:
    first, second = Channel.pair()
    large = {"text": "ä" * 3_000_000}
    sender = threading.Thread(target=lambda: [first.send(message) for message in (large, {"n": 2})])
    sender.start()
    assert second.receive(20) == large
    assert second.receive(20) == {"n": 2}
    sender.join()
    first.close()
    second.close()


def test_silence_is_a_timeout_and_an_end_is_an_end() -> None:
    first, second = Channel.pair()
    with pytest.raises(TimeoutError, match=r"within 0\.05 s"):
        second.receive(0.05)
    first.close()
    with pytest.raises(ChannelClosedError):
        second.receive(5)
    with pytest.raises(ChannelClosedError):
        second.send({"anyone": "there"})
    second.close()


def test_a_peer_that_stops_in_the_middle_of_a_message_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ipc, "_TRANSFER_S", 0.05)
    for begun in (b"\0", b"\0\0\0\2", b"\0\0\0\2{"):
        first, second = Channel.pair()
        os.write(first.fileno(), begun)
        with pytest.raises(ChannelClosedError, match="middle of a message"):
            second.receive()
        first.close()
        second.close()


class _PausingPoll:
    """A stand-in for `select.poll` whose object halts before it waits, as a thread may anywhere."""

    def __init__(self) -> None:
        self.reached, self.go_on = threading.Event(), threading.Event()

    def register(self, end: socket.socket, _: int) -> None:
        self._number = end.fileno()
        self._poll = _REAL_POLL()
        self._poll.register(end, select.POLLIN)

    def poll(self, milliseconds: float) -> list[tuple[int, int]]:
        self.reached.set()
        assert self.go_on.wait(200)
        os.fstat(self._number)  # still open
        return self._poll.poll(milliseconds)


_REAL_POLL = select.poll


def test_what_a_thread_polls_stays_open_when_another_one_hangs_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """Else its number can become another file's, and the thread waits for something that never comes."""
    ours, theirs = Channel.pair()
    number, pausing, ended = ours.fileno(), _PausingPoll(), []

    def wait() -> None:
        try:
            ours.receive(600)
        except ChannelClosedError as problem:
            ended.append(problem)

    monkeypatch.setattr(select, "poll", lambda: pausing)
    waiting = threading.Thread(target=wait)
    waiting.start()
    assert pausing.reached.wait(200)
    ours.hang_up()
    ours.hang_up()
    assert ours.fileno() == number
    pausing.go_on.set()
    waiting.join(200)
    monkeypatch.undo()
    assert len(ended) == 1
    assert ours.fileno() == -1  # the one who waited has closed it
    assert theirs.is_closed()
    theirs.close()

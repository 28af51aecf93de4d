"""Messages between the grader's processes."""

from __future__ import annotations

import gc
import os
import socket
import threading

import pytest

from course_kit.process.channel import Channel, ChannelClosedError


def test_messages_arrive_whole_and_in_order() -> None:
    first, second = map(Channel, socket.socketpair())
    large = {"text": "ä" * 3_000_000}
    sender = threading.Thread(target=lambda: [first.send(message) for message in (large, {"n": 2})])
    sender.start()
    assert second.receive(20) == large
    assert second.receive(20) == {"n": 2}
    sender.join()
    first.close()
    second.close()


def test_silence_is_a_timeout_and_an_end_is_an_end() -> None:
    first, second = map(Channel, socket.socketpair())
    with pytest.raises(TimeoutError, match=r"within 0\.05 s"):
        second.receive(0.05)
    first.close()
    with pytest.raises(ChannelClosedError):
        second.receive(5)
    with pytest.raises(ChannelClosedError):
        second.send({"anyone": "there"})
    second.close()


def test_what_a_thread_waits_on_stays_open_when_another_one_hangs_up() -> None:
    """Else its number can become another file's, and the thread waits for something that never comes."""
    ours, theirs = map(Channel, socket.socketpair())
    number, ended = ours.fileno(), []

    def wait(channel: Channel) -> None:
        try:
            channel.receive(600)
        except ChannelClosedError:
            ended.append(True)

    waiting = threading.Thread(target=wait, args=(ours,))
    waiting.start()
    ours.hang_up()
    ours.hang_up()
    assert ours.fileno() == number
    waiting.join(200)
    assert len(ended) == 1
    assert theirs.is_closed()
    assert ours.is_closed()
    theirs.close()
    del ours, waiting
    gc.collect()
    with pytest.raises(OSError, match="Bad file descriptor"):
        os.fstat(number)

"""Messages between the grader's processes."""

from __future__ import annotations

import os
import threading

import pytest

from course_kit.grading.workers import ipc
from course_kit.grading.workers.ipc import Channel, ChannelClosedError


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


@pytest.mark.parametrize(
    "data", [b"\xff\xff\xff\xff....", b"\x00\x00\x00\x02[]", b"\x00\x00\x00\x01{", b"\x00\x01\x86\xa0" + b"[" * 100_000]
)
def test_what_is_no_message_is_refused(data: bytes) -> None:
    first, second = Channel.pair()
    os.write(first.fileno(), data)
    with pytest.raises(ChannelClosedError, match="is not a message"):
        second.receive(5)
    first.close()
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


def test_a_peer_that_does_not_read_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ipc, "_TRANSFER_S", 0.05)
    first, second = Channel.pair()
    with pytest.raises(ChannelClosedError, match="no longer reads"):
        first.send({"text": "x" * 10_000_000})
    first.close()
    second.close()

"""Messages between the grader's own processes: JSON, each after its length, over a pair of sockets.

Only processes of the kit hold an end. JSON carries data and nothing else: no peer makes the receiver run anything.
"""

from __future__ import annotations

import json
import select
import socket
import struct
from contextlib import suppress
from typing import TYPE_CHECKING

import msgspec

from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from course_kit.grading.model.plain_data import Record

_LENGTH = struct.Struct("!I")
_STALLED_S = 30.0  # a peer that neither reads nor goes on writing for so long has stopped


class ChannelClosedError(ConnectionError):
    """The process at the other end has gone."""


class Channel(Closable):
    """One end of a two-way line of messages. For one thread at a time; any may hang up."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        end.settimeout(_STALLED_S)

    @classmethod
    def pair(cls) -> tuple[Channel, Channel]:
        """Two connected ends, neither inherited by programs that are started."""
        first, second = socket.socketpair()
        return cls(first), cls(second)

    def fileno(self) -> int:
        """The file descriptor, for `select`."""
        return self._socket.fileno()

    def send(self, message: Mapping[str, object]) -> None:
        """Send one message."""
        payload = json.dumps(message, default=msgspec.to_builtins).encode()
        try:
            self._socket.sendall(_LENGTH.pack(len(payload)) + payload)
        except OSError as problem:
            raise ChannelClosedError("the other process has ended, or no longer reads") from problem

    def receive(self, timeout: float | None = None) -> Record:
        """Wait for one message, at most `timeout` seconds for its beginning."""
        poll = select.poll()  # unlike select(), good for descriptors past 1023
        poll.register(self._socket, select.POLLIN)
        if not poll.poll(None if timeout is None else timeout * 1000):
            raise TimeoutError(f"no message from the other process within {timeout:g} s")
        (length,) = _LENGTH.unpack(self._receive_exactly(_LENGTH.size))
        message: Record = json.loads(self._receive_exactly(length))
        return message

    def is_closed(self) -> bool:
        """Whether nobody holds the other end, or we have hung up."""
        poll = select.poll()
        poll.register(self._socket, 0)  # poll reports a hang-up without being asked
        return bool(poll.poll(0))

    def hang_up(self) -> None:
        """End the connection for everybody; its number is free only when nobody polls it any more."""
        with suppress(OSError):  # the other end was faster
            self._socket.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Close this end; a copy of it in another process stays open."""
        self._socket.close()

    def __del__(self) -> None:
        self._socket.close()

    def _receive_exactly(self, count: int) -> bytes:
        parts = []
        while count:
            try:
                part = self._socket.recv(min(count, 1 << 20))
            except OSError as problem:
                raise ChannelClosedError("the other process has ended, or stopped") from problem
            if not part:
                raise ChannelClosedError("the other process has ended")
            parts.append(part)
            count -= len(part)
        return b"".join(parts)

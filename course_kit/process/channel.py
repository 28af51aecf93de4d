"""Messages between our own processes: JSON, each after its length, over a pair of sockets.

Only processes of the kit hold an end. JSON carries data and nothing else: no peer makes the receiver run anything.
"""

from __future__ import annotations

import json
import select
import socket
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import msgspec

from course_kit.process import Closable

if TYPE_CHECKING:
    from collections.abc import Mapping

_LENGTH_BYTES = 4
_STALLED_S = 30.0  # a peer that neither reads nor goes on writing for so long has stopped


class ChannelClosedError(ConnectionError):
    """The process at the other end has gone."""


class Channel(Closable):
    """One end of a two-way line of messages. For one thread at a time; any may hang up."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        self.fileno = end.fileno  # for `select`
        end.settimeout(_STALLED_S)

    def send(self, message: Mapping[str, object]) -> None:
        """Send one message."""
        payload = json.dumps(message, default=msgspec.to_builtins).encode()
        try:
            self._socket.sendall(len(payload).to_bytes(_LENGTH_BYTES, "big") + payload)
        except OSError as problem:
            raise ChannelClosedError("the other process has ended, or no longer reads") from problem

    def receive(self, timeout: float | None = None) -> dict[str, Any]:
        """Wait for one message, at most `timeout` seconds for its beginning."""
        poll = select.poll()  # unlike select(), good for descriptors past 1023
        poll.register(self._socket, select.POLLIN)
        if not poll.poll(None if timeout is None else timeout * 1000):
            raise TimeoutError(f"no message from the other process within {timeout:g} s")
        length = int.from_bytes(self._receive_exactly(_LENGTH_BYTES), "big")
        message: dict[str, Any] = json.loads(self._receive_exactly(length))
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

    __del__ = close

    def _receive_exactly(self, count: int) -> bytes:
        data = bytearray()
        with suppress(OSError):  # it was silent for too long, or has gone
            while len(data) < count and (part := self._socket.recv(count - len(data))):
                data += part
        if len(data) < count:
            raise ChannelClosedError("the other process has ended, or stopped")
        return bytes(data)

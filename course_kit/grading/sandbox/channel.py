"""Messages between the grader's own processes: JSON, each after its length, over a pair of sockets.

Only processes of the kit hold an end. JSON carries data and nothing else, so that even a peer gone wrong
cannot make the receiver run anything. Nor can it keep the receiver waiting: what has begun ends within a deadline.
"""

from __future__ import annotations

import json
import select
import socket
import struct
import threading
import time
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from course_kit.grading.model.plain_data import Record

_LENGTH = struct.Struct("!I")
_LARGEST = 64 * 1024 * 1024  # bytes; a report is a few kB, a submission at most 1 MiB
_TRANSFER_S = 30.0  # within which a message is over that has begun; a peer that takes longer has stopped


class ChannelClosedError(ConnectionError):
    """The process at the other end has gone, or does not speak our language any more."""


class Channel:
    """One end of a two-way line of messages. For one thread at a time; any may hang up."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        self._in_use = False
        self._hung_up = False
        self._lock = threading.Lock()  # for the two above

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
        with self._use():
            self._send(_LENGTH.pack(len(payload)) + payload)

    def receive(self, timeout: float | None = None) -> Record:
        """Wait for one message, at most `timeout` seconds for its beginning."""
        with self._use():
            if timeout is not None and not self.ready(timeout):
                raise TimeoutError(f"no message from the other process within {timeout:g} s")
            (length,) = _LENGTH.unpack(self._exactly(_LENGTH.size))
            if length > _LARGEST:
                raise ChannelClosedError("the other process sent something that is not a message")
            data = self._exactly(length, time.monotonic() + _TRANSFER_S)
        try:
            message = json.loads(data)
        except (ValueError, RecursionError):
            message = None
        if not isinstance(message, dict):
            raise ChannelClosedError("the other process sent something that is not a message")
        return message

    def ready(self, timeout: float = 0.0) -> bool:
        """Whether something can be read, or the other end has closed, within `timeout` seconds."""
        poll = select.poll()  # unlike select(), good for descriptors past 1023
        poll.register(self._socket, select.POLLIN)
        return bool(poll.poll(timeout * 1000))

    def is_closed(self) -> bool:
        """Whether nobody holds the other end any more, or we have hung up."""
        try:
            with self._use():
                poll = select.poll()
                poll.register(self._socket, 0)  # a hang-up is told without being asked for
                return bool(poll.poll(0))
        except ChannelClosedError:
            return True

    def hang_up(self) -> None:
        """End the connection for everybody, also for a thread of ours that waits for a message, and close.

        That thread closes when it is done: the number of what it polls must not become another file's meanwhile, as
        poll(2) looks at it again after it was woken.
        """
        with self._lock:
            if self._hung_up:
                return
            self._hung_up = True
            with suppress(OSError):  # the other end was faster
                self._socket.shutdown(socket.SHUT_RDWR)
            if not self._in_use:
                self._socket.close()

    def close(self) -> None:
        """Close this end; a copy of it in another process stays open."""
        self._socket.close()

    @contextmanager
    def _use(self) -> Iterator[None]:
        """Keep the socket open while it is used."""
        with self._lock:
            if self._hung_up:
                raise ChannelClosedError("this end was closed")
            self._in_use = True
        try:
            yield
        finally:
            with self._lock:
                self._in_use = False
                self._close_if_hung_up()

    def _close_if_hung_up(self) -> None:
        if self._hung_up:  # meanwhile, which a type checker does not see where it was looked at before
            self._socket.close()

    def _send(self, data: bytes) -> None:
        deadline = time.monotonic() + _TRANSFER_S
        left = memoryview(data)
        poll = select.poll()
        poll.register(self._socket, select.POLLOUT)
        while left:
            if not poll.poll(max(deadline - time.monotonic(), 0.0) * 1000):
                raise ChannelClosedError("the other process no longer reads")
            left = left[self._send_some(left) :]

    def _send_some(self, data: memoryview) -> int:
        """Send what there is room for; returns how many bytes that was."""
        try:
            return self._socket.send(data, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return 0
        except OSError as problem:
            raise ChannelClosedError("the other process has ended") from problem

    def _exactly(self, count: int, deadline: float | None = None) -> bytes:
        """So many bytes; without a deadline the first of them may take as long as it likes."""
        parts = []
        while count:
            if deadline is not None and not self.ready(max(deadline - time.monotonic(), 0.0)):
                raise ChannelClosedError("the other process stopped in the middle of a message")
            try:
                part = self._socket.recv(min(count, 1 << 20))
            except OSError as problem:
                raise ChannelClosedError("the other process has ended") from problem
            if not part:
                raise ChannelClosedError("the other process has ended")
            deadline = deadline or time.monotonic() + _TRANSFER_S
            parts.append(part)
            count -= len(part)
        return b"".join(parts)

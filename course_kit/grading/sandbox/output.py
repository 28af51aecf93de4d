"""What a submission printed: all of it counted, its first and last 4 kB kept."""

from __future__ import annotations

from course_kit.text.sanitize import make_printable

KEPT = 4096  # bytes, at the beginning and at the end


class BoundedOutput:
    """The bytes of one stream, in bounded memory however much comes."""

    def __init__(self) -> None:
        self.count = 0
        self._head = bytearray()
        self._tail = bytearray()

    def add(self, data: bytes) -> None:
        """Take in what has just come."""
        self.count += len(data)
        room = KEPT - len(self._head)
        if room > 0:
            self._head += data[:room]
            data = data[room:]
        if data:
            self._tail += data
            del self._tail[:-KEPT]

    def text(self) -> str:
        """What was kept, with a line that says how much was left out in the middle."""
        left_out = self.count - len(self._head) - len(self._tail)
        if left_out <= 0:
            return _decode(bytes(self._head + self._tail))
        return f"{_decode(bytes(self._head))}\n[... {left_out} bytes left out ...]\n{_decode(bytes(self._tail))}"


def _decode(data: bytes) -> str:
    return make_printable(data.decode("utf-8", errors="replace"))

"""What is known about one running submission: its output, its end, what it uses and what it was doing."""

from __future__ import annotations

import json
import os
import re
from contextlib import suppress
from typing import TYPE_CHECKING

from course_kit.text.sanitize import make_printable

if TYPE_CHECKING:
    from course_kit.grading.model.plain_data import Record
    from course_kit.grading.sandbox.start_order import Streams

_CHUNK = 1 << 20  # the most a pipe holds
KEPT = 4096  # bytes of a stream, at the beginning and at the end
_LISTS = ("node_classes", "classes", "functions", "set_names")
_TEXTS = ("returned", "result", "value", "lost_in")
_FACTS = ("exit_in_callback", "ended_itself", "too_large")
_NOTE_ITEMS, _NOTE_LENGTH = 20, 80
_ENDS = {"exit_code", "signal", "limit"}  # one of these facts says how a program has ended
_WATCHER_KILLED = "the process that watches the submission was killed, perhaps because the machine is out of memory"
_THREAD = re.compile(rb"^(?:Current thread|Thread) 0x(?P<id>[0-9a-f]+)\b.*\n", re.MULTILINE)
_EVIDENCE_TAKEN = 4 * 1024 * 1024  # bytes of one program; nobody listens after that
_EVIDENCE_KEPT = 65536  # bytes; a dump of all stacks of a ROS 2 program takes about 4 kB


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


class OutputCollector:
    """Collects what comes out of a sandbox. Only facts for the diagnosis: the inside can forge all of it."""

    def __init__(self, streams: Streams, totals: tuple[BoundedOutput, BoundedOutput]) -> None:
        self.over = streams.status < 0
        self.samples = 0
        self.printed_bytes = self.evidence_bytes = 0
        self.streams = streams
        self._output = {"stdout": BoundedOutput(), "stderr": BoundedOutput()}
        self._totals = dict(zip(("stdout", "stderr"), totals, strict=True))
        self.known: Record = {}  # from the init process, and by which limit we have stopped it
        self._notes: Record = {}
        self._status = b""
        self._evidence = b""

    def ask(self, what: bytes) -> None:
        """Ask the init process for `SAMPLE`, `STACKS` or `KILL`; the answer comes on its stream."""
        with suppress(OSError):  # it has ended; so its stream says
            os.write(self.streams.control, what + b"\n")

    def open_streams(self) -> dict[int, str]:
        """The descriptors that may still bring something, with their names."""
        names = ("stdout", "stderr", "evidence", "status")  # the last one's end closes all others
        return {getattr(self.streams, name): name for name in names if getattr(self.streams, name) >= 0}

    def take(self, name: str) -> None:
        """Read what has come on the stream `name`."""
        descriptor = getattr(self.streams, name)
        try:
            data = os.read(descriptor, _CHUNK)
        except BlockingIOError:
            return
        if not data:
            os.close(descriptor)
            setattr(self.streams, name, -1)
            if name == "status":
                self.take_the_rest()  # its last words explain the end
                if not _ENDS & set(self.known):
                    self.known.setdefault("problem", _WATCHER_KILLED)
        elif name == "status":
            *lines, self._status = (self._status + data).split(b"\n")
            for line in lines:
                with suppress(ValueError, TypeError):
                    self.known.update(json.loads(line))
                    self.samples += 1
        elif name == "evidence":
            self.evidence_bytes += len(data)
            self._evidence = (self._evidence + data)[-_EVIDENCE_KEPT:]
            if self.evidence_bytes > _EVIDENCE_TAKEN:  # written by the submission itself, to keep the grader busy
                os.close(descriptor)
                self.streams.evidence = -1
        else:
            self.printed_bytes += len(data)
            self._output[name].add(data)
            self._totals[name].add(data)

    def take_the_rest(self) -> None:
        """Read what is left when the program has ended."""
        # They need not end: a program may have sent them to a process that lives on. So no more than is there.
        for name in self.open_streams().values():
            self.take(name)
        self.over = True

    def forget_stacks(self) -> None:
        """Drop older dumps, keeping the program's notes."""
        self._read_notes()
        self._evidence = b""

    def has_whole_dump(self) -> bool:
        """Whether the dump of stacks is complete: another has begun after it."""
        return self._next_dump() > 0

    def stacks(self) -> str:
        """The first dump since `forget_stacks` of what every thread was executing, as faulthandler writes it."""
        return self._evidence[: self._next_dump() or None].decode("utf-8", errors="replace")

    def _next_dump(self) -> int:
        """Where the second dump begins, which is where a thread comes again, or 0."""
        seen = set()
        for match in _THREAD.finditer(self._evidence):
            if match["id"] in seen:
                return match.start()
            seen.add(match["id"])
        return 0

    def facts(self) -> Record:
        """All of it, as plain data."""
        self._read_notes()
        return {
            **self.known,
            "running": not self.over,
            "notes": self._notes,
            "stdout": self._output["stdout"].text(),
            "stderr": self._output["stderr"].text(),
        }

    def _read_notes(self) -> None:
        for line in self._evidence.split(b"\n"):
            if line.startswith(b'{"note"'):
                with suppress(ValueError, TypeError, KeyError, AttributeError, RecursionError):
                    self._notes.update(_keep_sound_fields(json.loads(line)["note"]))


def _keep_sound_fields(note: Record) -> Record:
    """What of a note has the shape the runner gives it: the submission can write here, too."""
    sound: Record = {}
    for name, value in note.items():
        if name in _LISTS and isinstance(value, list):
            sound[name] = [str(item)[:_NOTE_LENGTH] for item in value[:_NOTE_ITEMS]]
        elif name in _TEXTS and isinstance(value, str):
            sound[name] = value[:_NOTE_LENGTH]
        elif name in _FACTS:
            sound[name] = value is True
        elif name == "entries" and isinstance(value, list):
            sound[name] = [(str(key), str(text)) for key, text in value]
    return sound

"""The process: for each submission it forks a child with limits, waits until that has ended, and says how.

A request comes over a SOCK_SEQPACKET socket (unix(7)), as a small JSON object with two open files beside it, both in
memory: in one the child finds the submission, into the other it writes what it has read.
"""

from __future__ import annotations

import gc
import io
import json
import os
import re
import resource
import select
import signal
import socket
import sys
import traceback

from course_kit.reader import files, fingerprints, python, text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any, BinaryIO

CPU_S = 5  # 1 MiB of ordinary Python takes 0.3 s
WALL_S = 60.0  # what has not computed for CPU_S until then was kept from it by a busy machine
ANSWER_BYTES = 8 << 20  # a program has 1 MiB, and JSON writes a character in up to six
TOO_MUCH_MEMORY, FAILED = 69, 70  # exit statuses of a child; the second is a mistake of ours
_LARGEST = 64 * 1024  # bytes of a packet; a request holds a few names
_TOO_MUCH = "{} cannot be read: it has too many parts. Hand in only the cells that the exercise asks for."
_MOST_IMPORTS = 50
_IMPORT = re.compile(r"^[ \t]*(?:from|import)[ \t]+\.?(\w{1,80})", re.MULTILINE)


def apply_limits() -> None:
    """Hold this process to them; a machine may allow less, and nobody but root more (getrlimit(2))."""
    memory = python.MEMORY_MB << 20
    for what, soft, hard in (
        (resource.RLIMIT_CPU, CPU_S, CPU_S + 1),
        (resource.RLIMIT_AS, memory, memory),
        (resource.RLIMIT_FSIZE, ANSWER_BYTES, ANSWER_BYTES),
        (resource.RLIMIT_NOFILE, 8, 8),
        (resource.RLIMIT_NPROC, 0, 0),
        (resource.RLIMIT_CORE, 0, 0),
    ):
        _, highest = resource.getrlimit(what)
        most = hard if highest == resource.RLIM_INFINITY else min(hard, highest)
        resource.setrlimit(what, (min(soft, most), most))


def send_packet(line: socket.socket, message: Mapping[str, object], files: Sequence[int] = ()) -> None:
    """Send a packet."""
    socket.send_fds(line, [json.dumps(message).encode()], files)


def receive_packet(line: socket.socket, files: int = 0) -> tuple[dict[str, Any], list[int]]:
    """Wait for a packet."""
    data, descriptors, _, _ = socket.recv_fds(line, _LARGEST, files)
    if not data:
        raise EOFError("the other end is closed")
    return json.loads(data), descriptors


def main() -> None:
    """Serve the end of a line whose number is the first argument, until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one who asks, who then closes the line
    line = socket.socket(fileno=int(sys.argv[1]))
    gc.freeze()
    gc.disable()  # a child makes a million objects, keeps them, and ends
    try:
        while True:
            request, files = receive_packet(line, 2)
            try:
                ended = _in_a_child(line, request, *files)
            finally:
                for descriptor in files:
                    os.close(descriptor)
            send_packet(line, ended)
    except (OSError, EOFError):  # the process that asked has ended
        return


def _in_a_child(line: socket.socket, request: Mapping[str, Any], submission: int, answer: int) -> dict[str, object]:
    """How the child has ended: `status` as of waitpid(2), `late` if it had to be stopped, `cpu_s` it has computed."""
    alive, held = os.pipe()  # the child alone holds the other end
    child = os.fork()
    if child == 0:
        status = FAILED
        try:
            line.close()
            os.close(alive)
            apply_limits()
            _answer_request(request, submission, answer)
            status = 0
        except MemoryError:
            status = TOO_MUCH_MEMORY
        except BaseException:  # noqa: BLE001 - a fork must not go on in its parent's code
            traceback.print_exc()
        finally:
            os._exit(status)
    os.close(held)
    try:
        ready, _, _ = select.select([line.fileno(), alive], [], [], WALL_S)
        if alive not in ready:
            os.kill(child, signal.SIGKILL)  # not reaped yet: no other process has its number
        _, status, usage = os.wait4(child, 0)
    finally:
        os.close(alive)
    if line.fileno() in ready:  # nothing comes there now but its end
        raise EOFError("the process that asked has ended")
    return {"status": status, "late": not ready, "cpu_s": usage.ru_utime + usage.ru_stime}


def _answer_request(request: Mapping[str, Any], submission: int, answer: int) -> None:
    # Not by its position, which all who have it open share: a child whose reader was killed may be reading it, too.
    data = os.pread(submission, os.fstat(submission).st_size, 0)
    found = json.dumps(look_at(request["name"], io.BytesIO(data), request)).encode()
    if len(found) > ANSWER_BYTES:
        found = json.dumps({"found": True, "unreadable": _TOO_MUCH.format(request["name"])}).encode()
    with open(answer, "wb", closefd=False) as file:
        file.write(found)


def look_at(name: str, file: BinaryIO, wish: Mapping[str, Any]) -> dict[str, object]:
    """Whether a file holds what is asked for; why it cannot be read, or its program, and what that is compared by."""
    problem = source = ""
    places: list[tuple[str, int]] = []
    several: dict[str, files.Read] = {}
    try:
        if wish["files"]:
            several = files.read_files(name, file, wish["exercise"], wish["files"])
            source = files.join_sources(several)
        else:
            source, places = text.read_program(name, file, wish["exercise"])
    except text.UnreadableTextError as error:
        problem = str(error)
    seen = {
        "found": not several.keys().isdisjoint(wish["files"]) if several else _asked_for(name, file, source, wish),
        "identity": fingerprints.program_identity(source) if source else "",
        "imports": sorted(set(_IMPORT.findall(source)[:_MOST_IMPORTS])),
        "unreadable": problem,
    }
    if problem:
        return seen
    described = {name: _describe_file(name, read) for name, read in several.items()}
    program = {"source": source, "files": described} if several else _describe_program(source, places, wish["variable"])
    return {**seen, "prints": sorted(fingerprints.take_fingerprints(source)), "program": program}


def _describe_program(source: str, places: list[tuple[str, int]], variable: str = "") -> dict[str, object]:
    fault, tree = python.parse_program(source)
    return {
        "source": source,
        "places": places,
        "fault": fault,
        "facts": python.read_facts(tree) if tree else {},
        "twice": python.defined_twice(tree, [lines for _, lines in places]) if tree else "",
        "literal": python.read_literal(tree, variable) if tree and variable else None,
    }


def _describe_file(name: str, read: files.Read) -> dict[str, object]:
    named = {"name": name, "program": name}
    if isinstance(read, str):
        return {**named, "source": "", "fault": (0, "", f"the file {read}")}
    if text.kind_of_file(name) == text.PROGRAM:
        return {**named, **_describe_program(*read)}
    return {**named, "source": read[0], "places": read[1]}


def _asked_for(name: str, file: BinaryIO, program: str, wish: Mapping[str, Any]) -> bool:
    if text.kind_of_file(name) == text.NOTEBOOK or wish["files"]:
        if program:
            return True
        mark = rf"%%submission\s+{re.escape(wish['exercise'])}\b"
    else:
        mark = rf"^class {re.escape(wish['class_name'])}\b" if wish["class_name"] else rf"^{wish['variable']}\b"
    file.seek(0)
    looked_at = program or file.read().decode("utf-8", errors="replace")
    return re.search(mark, looked_at, re.MULTILINE) is not None

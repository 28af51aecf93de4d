"""The process: for each submission it forks a child with limits, waits until that has ended, and says how.

The child finds the submission in one open file and writes what it has read into a second one, both in memory.
"""

from __future__ import annotations

import gc
import io
import json
import os
import re
import select
import signal
import socket
import sys
import traceback

from course_kit.reader import contract, files, fingerprints, python, text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Mapping
    from typing import Any, BinaryIO

TOO_MUCH_MEMORY, FAILED = 69, 70  # exit statuses of a child; the second is a mistake of ours
_TOO_MUCH = "{} cannot be read: it has too many parts. Hand in only the cells that the exercise asks for."
_MOST_IMPORTS = 50
_IMPORT = re.compile(r"^[ \t]*(?:from|import)[ \t]+\.?(\w{1,80})", re.MULTILINE)


def main() -> None:
    """Serve the end of a line whose number is the first argument, until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the one who asks, who then closes the line
    line = socket.socket(fileno=int(sys.argv[1]))
    gc.freeze()
    gc.disable()  # a child makes a million objects, keeps them, and ends
    try:
        while True:
            request, files = contract.receive_packet(line, 2)
            try:
                ended = _in_a_child(line, request, *files)
            finally:
                for descriptor in files:
                    os.close(descriptor)
            contract.send_packet(line, ended)
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
            contract.apply_limits()
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
        ready, _, _ = select.select([line.fileno(), alive], [], [], contract.WALL_S)
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
    found = look_at(request["name"], io.BytesIO(data), request)
    told_as_bytes = json.dumps(found).encode()
    if len(told_as_bytes) > contract.ANSWER_BYTES:
        problem = _TOO_MUCH.format(request["name"])
        told_as_bytes = json.dumps({"found": True, "identity": "", "imports": [], "unreadable": problem}).encode()
    with open(answer, "wb", closefd=False) as file:
        file.write(told_as_bytes)


def look_at(name: str, file: BinaryIO, wish: Mapping[str, Any]) -> dict[str, object]:
    """Whether a file holds what is asked for; why it cannot be read; or its program, and what that is compared by."""
    problem = source = compared = ""
    places: list[tuple[int, int]] = []
    several: dict[str, files.Read] = {}
    try:
        if wish.get("files"):
            several = files.read_files(name, file, wish["exercise"], wish["files"])
            source = files.join_sources(several)
            compared = files.join_sources({name: several[name] for name in wish["files"] if name in several})
        else:
            source, places = text.read_program(name, file, wish["exercise"])
            compared = source
    except text.UnreadableTextError as error:
        problem = str(error)
    seen = {
        "found": not several.keys().isdisjoint(wish["files"]) if several else _asked_for(name, file, source, wish),
        "identity": fingerprints.program_identity(compared) if compared and wish["compared"] else "",
        "imports": sorted(set(_IMPORT.findall(source)[:_MOST_IMPORTS])),
        "unreadable": problem,
    }
    if problem or not (seen["found"] or wish["whatever"]):
        return seen
    program = (
        {"source": source, "files": {name: _describe_file(name, read) for name, read in several.items()}}
        if several
        else _describe_program(source, places, wish["variable"])
    )
    prints = sorted(fingerprints.take_fingerprints(source)) if wish["compared"] else []
    return {**seen, "prints": prints, "program": program}


def _describe_program(source: str, places: list[tuple[int, int]], variable: str = "") -> dict[str, object]:
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
    if text.kind_of_file(name) == text.NOTEBOOK or wish.get("files"):
        if program:
            return True
        mark = rf"%%submission\s+{re.escape(wish['exercise'])}\b"
    else:
        mark = rf"^class {re.escape(wish['class_name'])}\b" if wish["class_name"] else rf"^{wish['variable']}\b"
    file.seek(0)
    looked_at = program or file.read().decode("utf-8", errors="replace")
    return re.search(mark, looked_at, re.MULTILINE) is not None

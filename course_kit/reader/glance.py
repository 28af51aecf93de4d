"""A glance at a file that may be a submission: what it is for, whether its program is a known one, what it imports."""

from __future__ import annotations

import re

from course_kit.reader import fingerprints, text

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import BinaryIO

    from course_kit.reader.packets import Wish

_MOST_IMPORTS = 50
_IMPORT = re.compile(r"^[ \t]*(?:from|import)[ \t]+\.?(\w{1,80})", re.MULTILINE)


def at(name: str, file: BinaryIO, wish: Wish) -> dict[str, object]:
    """Look at a file; it may be broken."""
    places: list[tuple[int, int]] = []
    try:
        source, places = text.program(name, file, wish["exercise"])
    except text.UnreadableTextError:
        source = ""
    imports = sorted(set(_IMPORT.findall(source)[:_MOST_IMPORTS]))
    if not (found := _asked_for(name, file, source, wish)) or not source:
        return {"found": found, "identity": fingerprints.identity(source) if source else "", "imports": imports}
    compared = fingerprints.of_program(source)
    return {
        "found": True,
        "identity": compared["identity"],
        "imports": imports,
        "read": text.of_program(name, source, places, wish),
        "fingerprints": compared,
    }


def _asked_for(name: str, file: BinaryIO, program: str, wish: Wish) -> bool:
    if text.kind(name) == text.NOTEBOOK:
        if program:
            return True
        mark = rf"%%submission\s+{re.escape(wish['exercise'])}\b"
    else:
        mark = rf"^class {re.escape(wish['class_name'])}\b" if wish["class_name"] else rf"^{wish['variable']}\b"
    return re.search(mark, program or _all_of(file), re.MULTILINE) is not None


def _all_of(file: BinaryIO) -> str:
    """What is in a file, as text, whatever it is."""
    file.seek(0)
    return file.read().decode("utf-8", errors="replace")

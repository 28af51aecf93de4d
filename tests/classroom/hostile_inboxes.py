"""Inboxes as nobody should hand them in: some honest students, and beside and among them what a seed makes up."""

from __future__ import annotations

import os
import random
import stat
import struct
import unicodedata
import zipfile
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

PROGRAM = "temperature_service.py"
NAMES = ("ann", "bob", "cem", "dee", "eve", "fay")
_HONEST = {
    "canvas": ("{name}_{number}_9{number}_" + PROGRAM, "{number}", "mallory{k}_66{k}_966_", ""),
    "moodle": (
        "{name}_{number}_assignsubmission_file_/" + PROGRAM,
        "{number}",
        "m{k}_66{k}_assignsubmission_file_",
        "",
    ),
    "nbgrader": ("submitted/{name}/week/" + PROGRAM, "{name}", "", "submitted/"),
    "github": ("week-submissions/week-{name}/" + PROGRAM, "{name}", "week-", "week-submissions/"),
    "folders": ("{name}/" + PROGRAM, "{name}", "", ""),
    "files": ("{name}_" + PROGRAM, "{name}", "mallory{k}_", ""),
}
LAYOUTS = tuple(_HONEST)
_PIECES = (
    "bob",
    "BOB",
    "bob ",
    " bob",
    "bob.",
    "bob\u200f",
    "\u202ebob",
    "bob\x1b[31m",
    "bob\n",
    "b\u043eb",
    unicodedata.normalize("NFD", "jörg"),
    "jörg",
    "j\udcf6rg",
    "\ud83d".encode("utf-8", "surrogatepass").decode("utf-8", "surrogateescape"),
    "=cmd|' /C calc'!A0",
    "<script>alert(1)</script>",
    "..",
    "...",
    "-",
    "~",
    "bob~1a2b3c4d",
    "submitted",
    "week",
    "week-submissions",
    "x-submissions",
    "week-bob",
    "_12_assignsubmission_file_",
    "bob_12_assignsubmission_file_",
    "bob_12_assignsubmission_onlinetext_",
    "bob_12_912_",
    "_LATE_12_912_",
    "timestamp.txt",
    "gradebook.db",
    ".git",
    ".github",
    "__MACOSX",
    "._",
    ".DS_Store",
    "source",
    "release",
    PROGRAM,
    "temperature_service.ipynb",
    "temperature_service",
    ".py",
    ".ipynb",
    ".zip",
    "\u2215",
    "\\",
    "%2f",
    "\u3164",
    "9" * 30,
    "x" * 120,
    "あ" * 60,
)
_CONTENTS = (
    "",
    "pass\n",
    "class TemperatureService(Node):\n    pass\n",
    '{"cells": ["%%submission temperature_service"]}',
    "\0",
)


@dataclass
class Inbox:
    """What was made.

    Attributes:
        source: the folder or zip.
        layout: of the honest ones.
        honest: their identifiers and files.
        entries: all entries between which the students are told apart, as paths.
    """

    source: Path
    layout: str
    honest: dict[str, str] = field(default_factory=dict)
    entries: set[str] = field(default_factory=set)


class Maker:
    """Makes one inbox by a seed."""

    def __init__(self, seed: int, home: Path) -> None:
        self._chance = random.Random(seed)  # noqa: S311 - an example
        self._home = home
        layout = self._chance.choice(LAYOUTS)
        self.inbox = Inbox(home / "in", layout)
        pattern, student, self._begins, self._around = _HONEST[layout]
        for number, name in enumerate(NAMES, start=11):
            path = pattern.format(name=name, number=number)
            self.inbox.honest[student.format(name=name, number=number)] = path
            self._note(path)

    def folder(self) -> Inbox:
        """An inbox as a folder, with links, pipes and names that are not UTF-8."""
        root = self.inbox.source
        for path in self.inbox.honest.values():
            self._write(root / path, "pass\n")
        (self._home / "secret.py").write_text("class TemperatureService:\n    pass\n")  # outside of the inbox
        for number in range(self._chance.randrange(1, len(NAMES))):
            top = self._around + self._name(self._begins.format(k=number), 255)
            self._grow(root / top, 0)
        self.inbox.entries |= {self._around + path.name for path in (root / self._around).iterdir()}
        return self.inbox

    def archive(self, *, broken: bool) -> Inbox:
        """An inbox as a zip, with members that no tool writes; `broken` changes bytes of it at random."""
        self.inbox.source = self._home / "all.zip"
        with zipfile.ZipFile(self.inbox.source, "w", zipfile.ZIP_DEFLATED) as packed:
            for path in self.inbox.honest.values():
                packed.writestr(zipfile.ZipInfo(path), "pass\n")
            for number in range(self._chance.randrange(1, len(NAMES))):
                top = self._around + self._name(self._begins.format(k=number), 400)
                for _ in range(self._chance.randrange(1, 5)):
                    self._add(packed, top)
        if broken:
            data = bytearray(self.inbox.source.read_bytes())
            for _ in range(self._chance.randrange(1, 8)):
                data[self._chance.randrange(len(data))] = self._chance.randrange(256)
            self.inbox.source.write_bytes(data)
        return self.inbox

    def _note(self, path: str) -> None:
        self.inbox.entries.add(self._around + path.removeprefix(self._around).partition("/")[0])

    def _name(self, begin: str, longest: int) -> str:
        """A name that is none of the honest ones'."""
        while True:
            name = begin + "".join(self._chance.choices(_PIECES, k=self._chance.randrange(1, 4)))
            while len(os.fsencode(name)) > longest:
                name = name[:-1]
            if name not in (*NAMES, ".", "..", *(f"week-{one}" for one in NAMES)) and "/" not in name:
                return name

    def _grow(self, path: Path, depth: int) -> None:
        if os.path.lexists(path):
            return
        kind = self._chance.choice(("file", "file", "folder", "folder", "link", "pipe") if depth < 4 else ("file",))
        if kind == "file":
            self._write(path, self._chance.choice(_CONTENTS))
        elif kind == "link":
            to = self._chance.choice(("..", "../bob", self._home / "secret.py", f"../bob/{PROGRAM}", path.name, "/etc"))
            path.symlink_to(to)
        elif kind == "pipe":
            os.mkfifo(path)
        else:
            path.mkdir(parents=True)
            for _ in range(self._chance.randrange(5)):
                self._grow(path / self._name("", 255), depth + 1)

    def _write(self, path: Path, text: str) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def _add(self, packed: zipfile.ZipFile, top: str) -> None:
        inside = "/".join(self._name("", 400) for _ in range(self._chance.randrange(4)))
        name = self._chance.choice(
            (f"{top}/{inside}", f"{top}/{PROGRAM}", top, f"{top}/../{inside}", f"/{top}", f"{top}//./x")
        )
        member = zipfile.ZipInfo("x")
        member.filename = name.encode(errors="replace").decode()
        mode = self._chance.choice((0, 0, 0, stat.S_IFREG, stat.S_IFLNK, stat.S_IFBLK, stat.S_IFIFO, stat.S_IFDIR))
        member.external_attr = (mode | 0o777) << 16
        member.compress_type = self._chance.choice(
            (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
        )
        if self._chance.random() < 0.2:
            member.extra = struct.pack("<HH", 0x7075, 4) + b"\1abc"
        packed.writestr(member, self._chance.choice(_CONTENTS))
        if self._around == "" or name.startswith(self._around):
            self._note(member.filename.replace("//", "/").replace("/./", "/"))

"""Files are there as a whole: with a full disk, a killed writer, two writers, and readers meanwhile."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from typing import TYPE_CHECKING

import pytest

from course_kit.environment.files import write_atomically

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

LIMITED = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
"""
WRITE = """
import sys
from pathlib import Path
from course_kit.environment.files import write_atomically, write_new
try:
    {function}(Path(sys.argv[1]), bytes(5000))
except OSError as problem:
    print(problem)
"""


@pytest.fixture
def umask() -> Iterator[None]:
    before = os.umask(0o027)
    yield
    os.umask(before)


def another_process(path: Path, before: str, function: str = "write_atomically") -> subprocess.CompletedProcess[str]:
    code = before + WRITE.format(function=function)
    return subprocess.run(
        [sys.executable, "-c", code, str(path)], capture_output=True, text=True, timeout=60, check=False
    )


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def mode(path: Path) -> int:
    return path.stat().st_mode & 0o777


@pytest.mark.usefixtures("umask")
def test_the_mode_is_a_new_files_or_that_of_the_one_before(tmp_path: Path) -> None:
    shared, private = tmp_path / "folder" / "shared", tmp_path / "private"
    write_atomically(shared, "é\r\n")
    write_atomically(private, b"", mode=0o600)
    assert (mode(shared), mode(private)) == (0o640, 0o600)
    shared.chmod(0o444)
    write_atomically(shared, "ü\r\n", durable=False)
    assert mode(shared) == 0o444
    assert shared.read_bytes() == "ü\r\n".encode()


def test_a_link_is_replaced_and_what_it_leads_to_stays(tmp_path: Path) -> None:
    kept, link = tmp_path / "kept", tmp_path / "link"
    kept.write_text("old")
    link.symlink_to("kept")
    write_atomically(link, "new")
    assert (kept.read_text(), link.read_text(), link.is_symlink()) == ("old", "new", False)


def test_a_full_disk_leaves_what_was_there_and_no_rest(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    done = another_process(path, LIMITED)
    assert f"File too large: '{path}'" in done.stdout
    assert path.read_text() == "old"
    assert "File too large" in another_process(tmp_path / "new", LIMITED, "write_new").stdout
    assert names(tmp_path) == ["file"]


def test_what_is_in_the_way_is_named_by_its_own_name(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    path = tmp_path / "file" / "below"
    with pytest.raises(NotADirectoryError) as caught:
        write_atomically(path, "")
    assert caught.value.filename == str(path)
    with pytest.raises(FileNotFoundError):
        write_atomically(tmp_path / "no" / "folder", "", folders=False)
    assert names(tmp_path) == ["file"]


def test_two_may_write_while_others_read(tmp_path: Path) -> None:
    path = tmp_path / "file"
    contents = {letter * 100_000 for letter in "ab"}
    path.write_text(min(contents))

    def write(content: str) -> None:
        for _ in range(100):
            write_atomically(path, content, durable=False)

    writers = [threading.Thread(target=write, args=(content,)) for content in contents]
    for writer in writers:
        writer.start()
    seen = {path.read_text()}
    while any(writer.is_alive() for writer in writers):
        seen.add(path.read_text())
    assert seen <= contents
    assert path.read_text() in contents
    assert names(tmp_path) == ["file"]

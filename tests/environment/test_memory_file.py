"""Files in memory, and what stands in for them on systems that have none."""

from __future__ import annotations

import errno
import fcntl
import os

import pytest

from course_kit.environment.files import file_in_memory


def take_memfd_away(monkeypatch: pytest.MonkeyPatch, number: int | None) -> None:
    """Stands in for a macOS, which has no such function, or for a kernel or container that refuses it."""
    if number is None:
        monkeypatch.delattr(os, "memfd_create")
        return

    def refuse(_name: str, _flags: int = 0) -> int:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "memfd_create", refuse)


@pytest.mark.parametrize("number", [None, errno.ENOSYS, errno.EPERM])
def test_without_memfd_it_is_a_file_that_nobody_else_knows(monkeypatch: pytest.MonkeyPatch, number: int | None) -> None:
    take_memfd_away(monkeypatch, number)
    descriptor = file_in_memory("x")
    try:
        assert os.fstat(descriptor).st_nlink == 0
        assert fcntl.fcntl(descriptor, fcntl.F_GETFD) & fcntl.FD_CLOEXEC
        assert os.write(descriptor, b"abc") == 3
        assert os.pread(descriptor, 10, 0) == b"abc"
    finally:
        os.close(descriptor)


def test_too_many_open_files_are_no_reason_to_use_the_disk(monkeypatch: pytest.MonkeyPatch) -> None:
    take_memfd_away(monkeypatch, errno.EMFILE)
    with pytest.raises(OSError, match="Too many open files"):
        file_in_memory("x")

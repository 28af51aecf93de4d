"""Files that are in memory alone, and what stands in for them where a system has none."""

from __future__ import annotations

import errno
import os
import tempfile

_NOT_HERE = (errno.ENOSYS, errno.EPERM)  # a kernel without it, or a container that allows only calls it knows


def file_in_memory(name: str) -> int:
    """A descriptor of a new file that nobody else knows and that is gone when it is closed; it is not inherited.

    Where there is no memfd_create(2), as on macOS, it is a temporary file without a name.
    """
    try:
        return os.memfd_create(name, os.MFD_CLOEXEC)
    except AttributeError:
        pass
    except OSError as problem:
        if problem.errno not in _NOT_HERE:
            raise
    descriptor, path = tempfile.mkstemp(prefix="course-kit-")
    os.unlink(path)  # noqa: PTH108 - a path of the operating system's
    return descriptor

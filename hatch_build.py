"""Build hook: compiles the one small C file of the live interfaces and installs the start-up file.

The C file needs neither Python's nor ROS's headers, so any C compiler will do: the system's, else the one in
the `ziglang` wheel, which is asked for only when there is no other.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import zlib
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SOURCE = Path("course_kit/interfaces/native/helper.c")
LIBRARY = SOURCE.with_name("_helper.so")
START_UP = Path("course_kit/course_kit.pth")


def system_compiler() -> list[str] | None:
    """The C compiler of this machine as a command, or None. `CC` wins, as everywhere."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        words = name.split()
        if words and shutil.which(words[0]):
            return words
    return None


def compile_helper(root: Path) -> None:
    """Compile the helper beside its source; it is replaced whole, so that a running kernel keeps its own."""
    compiler = system_compiler() or [sys.executable, "-m", "ziglang", "cc"]
    target = root / LIBRARY
    fresh = target.with_suffix(f".{os.getpid()}.tmp")
    command = [
        *compiler,
        "-O2",
        "-fPIC",
        "-shared",
        "-std=c11",
        "-Wall",
        "-Wextra",
        f"-DSOURCE_CRC={zlib.crc32((root / SOURCE).read_bytes())}u",  # the loader compares it
        "-o",
        str(fresh),
        str(root / SOURCE),
    ]
    try:
        subprocess.run(command, check=True)
        fresh.replace(target)
    finally:
        fresh.unlink(missing_ok=True)


class CustomBuildHook(BuildHookInterface):
    """Hatchling's entry point."""

    def dependencies(self) -> list[str]:
        """Packages the build needs beyond hatchling: a compiler where the machine has none."""
        return [] if system_compiler() else ["ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, then add the library and the start-up file to the wheel."""
        root = Path(self.root)
        compile_helper(root)
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-linux_{platform.machine()}"  # C, but none of Python's ABI
        if version == "editable":
            build_data["force_include_editable"][str(root / START_UP)] = START_UP.name
        else:
            build_data["force_include"][str(root / LIBRARY)] = str(LIBRARY)
            build_data["force_include"][str(root / START_UP)] = START_UP.name

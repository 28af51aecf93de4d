"""Build hook: compiles the one small C file of the live interfaces and installs the start-up file.

The C file needs neither Python's nor ROS's headers, so any C compiler will do: the system's, else the one in
the `ziglang` wheel, which is asked for only when no other works. Whether one works is tried on the file itself: a
gcc may be there without the headers of the C library, and `CC` may compile for another machine.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import zlib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

SOURCE = Path("course_kit/interfaces/native/helper.c")
LIBRARY = SOURCE.with_name("_helper.so")
START_UP = Path("course_kit/course_kit.pth")


ZIG = [sys.executable, "-m", "ziglang", "cc"]
LOAD = "import ctypes, sys; ctypes.CDLL(sys.argv[1])"


class NoCompilerError(RuntimeError):
    """No compiler could compile the helper; the text is for the user."""


def system_compilers() -> Iterator[list[str]]:
    """The C compilers of this machine as commands. `CC` comes first, as everywhere."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        words = name.split()
        if words and shutil.which(words[0]):
            yield words


def try_to_compile(compiler: list[str], root: Path, target: Path) -> str:
    """Compile the helper and load it once; returns why that failed, or "" where it did not."""
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
        str(target),
        str(root / SOURCE),
    ]
    for step in (command, [sys.executable, "-I", "-S", "-c", LOAD, str(target)]):
        try:
            done = subprocess.run(step, capture_output=True, text=True, errors="replace", timeout=300, check=False)
        except (OSError, subprocess.TimeoutExpired) as problem:
            return str(problem)
        if done.returncode:
            return done.stderr.strip() or f"{step[0]} ended with status {done.returncode}"
    return ""


def compile_helper(root: Path, compilers: Iterable[list[str]]) -> None:
    """Compile the helper beside its source with the first compiler that can.

    It is replaced whole, so that a running kernel keeps its own.

    Args:
        root: the course's folder.
        compilers: commands to try in this order.

    Raises:
        NoCompilerError: none of them can.
    """
    fresh = (root / LIBRARY).with_suffix(f".{os.getpid()}.tmp")
    failures = []
    try:
        for compiler in compilers:
            failure = try_to_compile(compiler, root, fresh)
            if not failure:
                fresh.replace(root / LIBRARY)
                return
            failures.append(f"{' '.join(compiler)}: {failure}")
    finally:
        fresh.unlink(missing_ok=True)
    raise NoCompilerError("\n\n".join(["No C compiler here can compile the course's helper.", *failures]))


def can_be_compiled(root: Path) -> bool:
    """Whether a compiler of this machine can compile the helper."""
    trial = (root / LIBRARY).with_suffix(f".{os.getpid()}.tmp")  # /tmp may let no library be loaded
    try:
        return any(not try_to_compile(one, root, trial) for one in system_compilers())
    finally:
        trial.unlink(missing_ok=True)


class CustomBuildHook(BuildHookInterface):
    """Hatchling's entry point."""

    def dependencies(self) -> list[str]:
        """Packages the build needs beyond hatchling: a compiler where the machine has none that works."""
        return [] if can_be_compiled(Path(self.root)) else ["ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, then add the library and the start-up file to the wheel."""
        root = Path(self.root)
        compile_helper(root, [*system_compilers(), ZIG])
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-linux_{platform.machine()}"  # C, but none of Python's ABI
        if version == "editable":
            build_data["force_include_editable"][str(root / START_UP)] = START_UP.name
        else:
            build_data["force_include"][str(root / LIBRARY)] = str(LIBRARY)
            build_data["force_include"][str(root / START_UP)] = START_UP.name

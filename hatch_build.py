"""Build hook: compiles the one small C file of the live interfaces, and puts lessons and exercises into the wheel.

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
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

SOURCE = Path("course_kit/interfaces/native/helper.c")
LEAVING = SOURCE.with_name("leaving.c")
LIBRARY = SOURCE.with_name("_helper.so")
START_UP = Path("course_kit/course_kit.pth")
# Lessons and exercises, as `course_kit.environment.course_files` looks for them; without what only instructors need.
COURSE = Path("course_kit/course")
HANDED_OUT = ("notebooks", "exercises")
LEFT_OUT = (".*", "__pycache__", "*.backup-*", "*.new-version*", "*.tmp", "solution", "proof")
# For whom a wheel is made that others install, as zig names them: by the oldest glibc that the ROS wheels run with.
MACHINE = "COURSE_KIT_WHEEL_FOR"
GLIBC = (2, 28)


ZIG = [sys.executable, "-m", "ziglang", "cc"]
SOURCE_OF = "import ctypes, sys; print(ctypes.CDLL(sys.argv[1]).live_source() & 0xFFFFFFFF)"
LOAD = "import ctypes, sys; ctypes.CDLL(sys.argv[1])"


class NoCompilerError(RuntimeError):
    """No compiler could compile the helper; the text is for the user."""


class ChangedExercisesError(RuntimeError):
    """The wheel would hand out exercises that somebody has worked on; the text is for the user."""


def system_compilers() -> Iterator[list[str]]:
    """The C compilers of this machine as commands. `CC` comes first, as everywhere."""
    for name in (os.environ.get("CC", ""), "cc", "gcc", "clang"):
        words = name.split()
        if words and shutil.which(words[0]):
            yield words


def try_to_compile(compiler: list[str], root: Path, target: Path, *, foreign: bool = False) -> str:
    """Compile the helper and load it once; returns why that failed, or "" where it did not.

    Args:
        compiler: a command.
        root: the course's folder.
        target: the library to be made.
        foreign: it is for another kind of machine, so it cannot be loaded.
    """
    command = [
        *compiler,
        "-O2",
        "-fPIC",
        "-shared",
        "-std=c11",
        "-Wall",
        "-Wextra",
        f"-DSOURCE_CRC={source_checksum(root)}u",  # the loader compares it
        "-Wl,-Bsymbolic",  # further copies of it call their own functions
        "-o",
        str(target),
        str(root / SOURCE),
        str(root / LEAVING),
        "-ldl",  # of its own before glibc 2.34
    ]
    load = [sys.executable, "-I", "-S", "-c", LOAD, str(target)]
    for step in [command] if foreign else [command, load]:
        try:
            done = subprocess.run(step, capture_output=True, text=True, errors="replace", timeout=300, check=False)
        except (OSError, subprocess.TimeoutExpired) as problem:
            return str(problem)
        if done.returncode:
            return done.stderr.strip() or f"{step[0]} ended with status {done.returncode}"
    return ""


def compile_helper(
    root: Path, compilers: Iterable[list[str]], library: Path = LIBRARY, *, foreign: bool = False
) -> None:
    """Compile the helper beside its source with the first compiler that can.

    It is replaced whole, so that a running kernel keeps its own.

    Args:
        root: the course's folder.
        compilers: commands to try in this order.
        library: what is made, below that folder.
        foreign: it is for another kind of machine.

    Raises:
        NoCompilerError: none of them can.
    """
    fresh = (root / LIBRARY).with_suffix(f".{os.getpid()}.tmp")
    failures = []
    try:
        for compiler in compilers:
            failure = try_to_compile(compiler, root, fresh, foreign=foreign)
            if not failure:
                fresh.replace(root / library)
                return
            failures.append(f"{' '.join(compiler)}: {failure}")
    finally:
        fresh.unlink(missing_ok=True)
    raise NoCompilerError("\n\n".join(["No C compiler here can compile the course's helper.", *failures]))


def source_checksum(root: Path) -> int:
    """What tells a helper that was made from other sources."""
    return zlib.crc32((root / LEAVING).read_bytes(), zlib.crc32((root / SOURCE).read_bytes()))


def is_compiled(root: Path) -> bool:
    """Whether the helper lies beside its source, was made from it and can be loaded here."""
    wanted = str(source_checksum(root))
    command = [sys.executable, "-I", "-S", "-c", SOURCE_OF, str(root / LIBRARY)]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip() == wanted


def can_be_compiled(root: Path) -> bool:
    """Whether a compiler of this machine can compile the helper, which is then done."""
    try:
        if not is_compiled(root):
            compile_helper(root, system_compilers())
    except NoCompilerError:
        return False
    return True


def lessons_and_exercises(root: Path) -> dict[str, str]:
    """By file of the course's folder where it lies in the wheel.

    Raises:
        ChangedExercisesError: git calls a file in `exercises/` changed: the wheel would hand out somebody's answer.
    """
    found = {}
    if changed := _git_lists(root, "--modified", "exercises"):
        raise ChangedExercisesError(
            f"The exercises were changed since git last saw them: {', '.join(sorted(changed))}. "
            "Take the changes back with git restore exercises, or keep them with git add exercises."
        )
    known = _git_lists(root, "--cached", *HANDED_OUT)
    for name in HANDED_OUT:
        for folder, folders, files in os.walk(root / name):
            folders[:] = sorted(each for each in folders if not _is_left_out(each))
            for each in sorted(files):
                source = Path(folder, each)
                if _is_left_out(each) or (known is not None and str(source.relative_to(root)) not in known):
                    continue
                found[str(source)] = (COURSE / source.relative_to(root)).as_posix()
    return found


def _git_lists(root: Path, which: str, *folders: str) -> set[str] | None:
    """The files in folders of a clone, where others may lie, that git knows or calls changed; None in an archive."""
    if not (root / ".git").exists():
        return None
    command = ["git", "-C", str(root), "ls-files", "-z", which, "--", *folders]
    try:
        listed = subprocess.run(command, capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):  # no git here, or it does not trust the folder's owner
        return None
    return {os.fsdecode(name) for name in listed.split(b"\0") if name}


def _is_left_out(name: str) -> bool:
    return any(fnmatch(name, pattern) for pattern in LEFT_OUT)


def compilers_for(machine: str) -> list[list[str]]:
    """The compilers to try: for this machine any, for a wheel that is handed on zig, which knows old C libraries.

    Args:
        machine: as `platform.machine` names it; empty for the one that the wheel is made on.
    """
    if not machine:
        return [*system_compilers(), ZIG]
    return [[*ZIG, "-target", f"{machine}-linux-gnu.{'.'.join(map(str, GLIBC))}"]]


class CustomBuildHook(BuildHookInterface):
    """Hatchling's entry point."""

    def dependencies(self) -> list[str]:
        """Packages the build needs beyond hatchling: a compiler where the machine has none that works."""
        here = self.target_name != "wheel" or (not os.environ.get(MACHINE) and can_be_compiled(Path(self.root)))
        return [] if here else ["ziglang>=0.13"]

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Compile, then add the library, the start-up file, lessons and exercises to the wheel."""
        root, machine = Path(self.root), _machine(version)
        library = _library_for(machine)
        if machine or not is_compiled(root):  # as the question for a compiler has left it
            compile_helper(root, compilers_for(machine), library, foreign=machine not in ("", platform.machine()))
        build_data["pure_python"] = False
        glibc = "_".join(map(str, GLIBC))
        platform_tag = f"manylinux_{glibc}_{machine}" if machine else f"linux_{platform.machine()}"
        build_data["tag"] = f"py3-none-{platform_tag}"  # C, but none of Python's ABI
        if version == "editable":
            build_data["force_include_editable"][str(root / START_UP)] = START_UP.name
        else:
            build_data["force_include"][str(root / library)] = str(LIBRARY)
            build_data["force_include"][str(root / START_UP)] = START_UP.name
            build_data["force_include"].update(lessons_and_exercises(root))

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Remove what was made for this wheel alone; the helper beside its source serves this folder."""
        del build_data, artifact_path
        if machine := _machine(version):
            (Path(self.root) / _library_for(machine)).unlink(missing_ok=True)


def _machine(version: str) -> str:
    """For which machine this is made; empty for this one, as a clone's own set-up always is."""
    return "" if version == "editable" else os.environ.get(MACHINE, "")


def _library_for(machine: str) -> Path:
    return LIBRARY.with_suffix(f".{machine}.so") if machine else LIBRARY

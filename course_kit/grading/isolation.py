"""Which walls stand between a submission and the rest on this machine, found by trying.

Namespaces may be compiled out, switched off, or allowed in name and useless in fact; so each is set up
for real in a child process that is thrown away. The grader then uses what worked, and says so.
"""

from __future__ import annotations

import errno
import json
import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import Any

from course_kit.grading import namespaces

_REASONS = {
    errno.ENOSPC: "this machine allows no more user namespaces (sysctl user.max_user_namespaces): ",
    errno.EPERM: "this machine forbids user namespaces (AppArmor on Ubuntu, or the container it runs in): ",
    errno.EACCES: "this machine forbids user namespaces (AppArmor on Ubuntu, or the container it runs in): ",
    errno.ENOSYS: "this kernel is too old: ",
    errno.EINVAL: "this kernel lacks a kind of namespace: ",
}
_PATIENCE_S = 20.0  # a hang of the trial is a fault of ours; a noisy machine needs less than one second


@dataclass(frozen=True)
class Isolation:
    """What holds beside resource limits, an own session and an own scratch directory, which always do.

    Attributes:
        network: own network namespace: only the grader and the submission are on its loopback.
        processes: own PID namespace: the submission can neither see, signal nor trace anything outside, and
            the kernel ends all it has started together with it.
        files: the whole file system read-only but for the scratch directory, which lies in memory.
        reason: why something of these is missing, for people; empty when all hold.
    """

    network: bool = False
    processes: bool = False
    files: bool = False
    reason: str = ""

    @classmethod
    def from_mapping(cls, values: dict[str, Any]) -> Isolation:
        """The inverse of `to_mapping`."""
        return cls(**values)

    def to_mapping(self) -> dict[str, Any]:
        """The state as plain data: three booleans and the reason."""
        return asdict(self)

    def describe(self) -> str:
        """One line for people."""
        walls = (
            ("own network (loopback only)", "network", self.network),
            ("own processes", "processes", self.processes),
            ("read-only files", "files", self.files),
        )
        standing = [name for name, _, stands in walls if stands]
        missing = [kind for _, kind, stands in walls if not stands]
        always = "resource limits, own session, own ROS domain, scratch directory"
        text = ", ".join([*standing, always])
        return f"{text}. No wall around {', '.join(missing)}: {self.reason or 'unknown why'}" if missing else text


def status() -> Isolation:
    """What holds on this machine, tried out in a fresh process; safe from a kernel or any other thread.

    Never raises: where even the trial fails, nothing holds and the reason tells why.
    """
    try:
        trial = subprocess.run(
            [sys.executable, "-c", "from course_kit.grading import isolation; isolation.print_trial()"],
            capture_output=True,
            text=True,
            timeout=_PATIENCE_S,
            check=True,
        )
        return Isolation.from_mapping(json.loads(trial.stdout))
    except (OSError, subprocess.SubprocessError, ValueError, TypeError) as problem:
        return Isolation(reason=f"trying it out failed ({problem})")


def try_out() -> Isolation:
    """Set up each wall in a child process and report which stand. Only for a process with one thread."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(reader)
            _try_network(writer)
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as lines:
        told = [line.rstrip("\n") for line in lines]
    os.waitpid(child, 0)
    problems = [line[1:].strip() for line in told if line.startswith("!")]
    reason = "; ".join(problems)
    return Isolation("network" in told, "processes" in told, "files" in told, reason)


def enter_network() -> None:
    """Put this process and its later children into a network of their own with nothing but loopback."""
    namespaces.enter(namespaces.CLONE_NEWNET)
    namespaces.raise_loopback()


def enter_processes() -> None:
    """Give the later children of this process PIDs, mounts, host name and System V memory of their own."""
    namespaces.enter(
        namespaces.CLONE_NEWPID | namespaces.CLONE_NEWNS | namespaces.CLONE_NEWIPC | namespaces.CLONE_NEWUTS
    )


def arrange_files(scratch: str, megabytes: int, hidden: tuple[str, ...] = ()) -> None:
    """Make all files read-only but for `scratch` and /dev/shm, and empty the folders `hidden`."""
    namespaces.detach_mounts()
    with suppress(OSError):  # refused inside containers that mask parts of /proc; then the old one stays
        namespaces.mount_processes()
    namespaces.make_files_read_only()
    for folder in hidden:
        if os.path.isdir(folder):  # noqa: PTH112 - a plain string from the job, asked just before the mount
            namespaces.mount_scratch(folder, 1)
    namespaces.mount_scratch("/dev/shm", megabytes)  # noqa: S108 - a mount point, not a file of ours
    namespaces.mount_scratch(scratch, megabytes)


def _try_network(writer: int) -> None:
    if _stands(writer, "network", enter_network) and _stands(writer, "", enter_processes):
        child = os.fork()
        if child == 0:
            try:
                _say(writer, "processes")
                _stands(writer, "files", lambda: arrange_files("/var", 1))
            finally:
                os._exit(0)
        os.waitpid(child, 0)


def _stands(writer: int, name: str, build: Any) -> bool:
    try:
        build()
    except Exception as problem:  # noqa: BLE001 - a trial that breaks says so, and the wall counts as missing
        if not isinstance(problem, OSError):
            _say(writer, f"! {type(problem).__name__}: {problem}")
            return False
        _say(writer, f"! {_REASONS.get(problem.errno or 0, '')}{problem.strerror or problem}")
        return False
    if name:
        _say(writer, name)
    return True


def _say(writer: int, line: str) -> None:
    os.write(writer, line.replace("\n", " ").encode() + b"\n")


def print_trial() -> None:
    """Try out and print the outcome as JSON, for `status`."""
    sys.stdout.write(json.dumps(try_out().to_mapping()))

"""A very long class: `python benchmarks/endurance.py [--size 10000]`. Does anything leak?

One run of `course-kit class` over the mixed submissions of `class.py` (right, wrong, crashing, greedy, one in 50 that
never ends), all different. Meanwhile it is counted, every few seconds, what the run holds: processes, open files and
memory of those that live as long as the run (the command, the warm process, the workers, and the processes that start
submissions), processes that nobody has reaped, files in /dev/shm, and what lies in the temporary folder. A lease of a
ROS domain is a socket, and so among the open files. The table shows what was held at the beginning, in the middle and
at the end of the run, and after it. Beginning, middle and end are the medians of a fifth of the samples each; what was
there before the run is taken off.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

import psutil
from class_rivals import FULL, Ours
from class_submissions import large
from class_usage import resident

if TYPE_CHECKING:
    from collections.abc import Sequence

    from class_submissions import Submission

SIZE = 10_000
_SAMPLE_S = 2.0
_LONG_LIVED_S = 60.0  # older than any grading of this class
_FIFTHS = 5
_SETTLE_S = 3.0
_KB = 1024


@dataclass(frozen=True)
class Sample:
    """What is held at one moment; those that live long are the run's own processes, the rest belongs to gradings."""

    processes: float
    long_lived: float
    files_of_long_lived: float
    command_kb: float
    long_lived_kb: float
    not_reaped: float
    shared_memory: float
    temporary: float


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--size", type=int, default=SIZE, help=f"how many submissions ({SIZE})")
    parser.add_argument("--workers", type=int, default=0, help="of the class run (its default)")
    options = parser.parse_args()
    submissions = large(options.size)
    with tempfile.TemporaryDirectory(dir=_outside()) as folder:
        ours = Ours(Path(folder) / "ours", 0, options.workers)
        ours.prepare(submissions)
        temporary = Path(folder) / "tmp"
        temporary.mkdir(mode=0o711)
        before = look(None, temporary)
        samples, seconds = run(ours, submissions, temporary)
        time.sleep(_SETTLE_S)  # the kernel is still taking away what the last ones had
        after = look(None, temporary)
        reports = ours.reports()
    errors = sum(report["status"] == "error" for report in reports.values())
    wrong = sum((one.kind == "right") != (reports.get(one.student, {}).get("score") == FULL) for one in submissions)
    print(
        f"{len(reports)} of {len(submissions)} gradings in {seconds:.0f} s, {seconds / len(submissions):.3f} s each; "
        f"{errors} errors of the grader, {wrong} with another grade than they should have\n"
    )
    show(samples, before, after)


def run(ours: Ours, submissions: Sequence[Submission], temporary: Path) -> tuple[list[Sample], float]:
    """Grade the class and look at it meanwhile; returns the samples and the seconds it took."""
    (command,) = ours.queue(submissions)
    samples, began = [], time.monotonic()
    with command.log.open("ab") as log:
        process = subprocess.Popen(
            command.words,
            cwd=command.folder,
            env={**command.variables, "TMPDIR": str(temporary)},
            stdout=log,
            stderr=subprocess.STDOUT,
        )
        while process.poll() is None:
            time.sleep(_SAMPLE_S)
            if time.monotonic() - began > _LONG_LIVED_S and process.poll() is None:
                samples.append(look(process.pid, temporary))
    return samples, time.monotonic() - began


def look(command: int | None, temporary: Path) -> Sample:
    """Count once; without a command only what does not belong to its processes."""
    family = _family(command) if command is not None else []
    lasting = [one for one in family if time.time() - one.create_time() > _LONG_LIVED_S]
    return Sample(
        processes=len(family),
        long_lived=len(lasting),
        files_of_long_lived=sum(_open_files(one) for one in lasting),
        command_kb=resident(command) / _KB if command is not None else 0,
        long_lived_kb=sum(resident(one.pid) for one in lasting) / _KB,
        not_reaped=sum(_is_zombie(one) for one in family),
        shared_memory=_entries(Path("/dev/shm")),  # noqa: S108 - it is only counted
        temporary=_entries(temporary),
    )


def show(samples: list[Sample], before: Sample, after: Sample) -> None:
    """Print the table."""
    part = max(1, len(samples) // _FIFTHS)
    middle = len(samples) // 2 - part // 2
    spans = {"beginning": samples[:part], "middle": samples[middle : middle + part], "end": samples[-part:]}
    print(f"  {'':<24}" + "".join(f"{name:>12}" for name in (*spans, "afterwards")))
    for field in fields(Sample):
        held = [
            statistics.median(getattr(sample, field.name) for sample in span) - getattr(before, field.name)
            if span
            else float("nan")
            for span in spans.values()
        ]
        held.append(getattr(after, field.name) - getattr(before, field.name))
        print(f"  {field.name.replace('_', ' '):<24}" + "".join(f"{value:>12.0f}" for value in held))


def _family(command: int) -> list[psutil.Process]:
    try:
        parent = psutil.Process(command)
        return [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return []


def _open_files(process: psutil.Process) -> int:
    try:
        return process.num_fds()
    except psutil.Error:
        return 0


def _is_zombie(process: psutil.Process) -> bool:
    try:
        return process.status() == psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False


def _entries(folder: Path) -> int:
    try:
        return sum(1 for _ in folder.iterdir())
    except OSError:
        return 0


def _outside() -> str | None:
    """A folder for the class that has room for ten thousand reports: the temporary one may lie in memory."""
    return str(Path("/var/tmp")) if Path("/var/tmp").is_dir() else None  # noqa: S108 - the usual place


if __name__ == "__main__":
    sys.exit(main())

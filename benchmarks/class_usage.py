"""What a set of commands costs: wall seconds, computing seconds of all processes, and the most memory at a time."""

from __future__ import annotations

import resource
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import psutil

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from typing_extensions import Self

PATIENCE_S = 3600
_SAMPLE_S = 0.5
_REST = 20  # times as long as a look at the memory has taken: else looking takes a fifth of a processor from the class
_MB = 1024**2


@dataclass(frozen=True)
class Command:
    """Words, and where and how they are run."""

    words: Sequence[str]
    folder: Path
    variables: Mapping[str, str]
    log: Path


@dataclass(frozen=True)
class Usage:
    """What was used.

    Attributes:
        wall_s: from the first start to the last end.
        cpu_s: user and system time of all processes, those that were forked and reaped on the way included.
        memory_mb: the most memory all processes had together, shared pages counted once; of a sample each half second,
            of many processes less often.
    """

    wall_s: float
    cpu_s: float
    memory_mb: float


def measure(queues: Sequence[Sequence[Command]]) -> Usage:
    """Run the queues side by side, the commands of each one after the other."""
    with _Memory() as memory:
        cpu, began = _children_cpu(), time.monotonic()
        with ThreadPoolExecutor(len(queues)) as threads:
            list(threads.map(_run_queue, queues))
        return Usage(time.monotonic() - began, _children_cpu() - cpu, memory.most / _MB)


def _run_queue(queue: Sequence[Command]) -> None:
    for command in queue:
        with command.log.open("ab") as log:
            subprocess.run(
                command.words,
                cwd=command.folder,
                env=dict(command.variables),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                timeout=PATIENCE_S,
                check=False,  # a contestant may end with 1 where a submission failed; what counts are its scores
            )


def _children_cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class _Memory:
    """Looks at the process tree now and then."""

    def __init__(self) -> None:
        self.most = 0
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._end.set()
        self._thread.join()

    def _watch(self) -> None:
        me = psutil.Process()
        pause = _SAMPLE_S
        while not self._end.wait(pause):
            began = time.thread_time()
            self.most = max(self.most, sum(resident(child.pid) for child in me.children(recursive=True)))
            pause = max(_SAMPLE_S, _REST * (time.thread_time() - began))


def resident(process_id: int) -> int:
    """A process's share of the memory: of a page that n processes have together, one n-th."""
    try:
        text = Path(f"/proc/{process_id}/smaps_rollup").read_text(encoding="ascii")
    except OSError:  # it has ended, or is none of ours
        return 0
    return next((int(line.split()[1]) * 1024 for line in text.splitlines() if line.startswith("Pss:")), 0)


def python(*words: str) -> list[str]:
    """A command of this environment's Python."""
    return [sys.executable, *words]

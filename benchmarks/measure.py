"""What the benchmarks share: interleaved measurements, a table in which ratios count, and what commands cost.

Seconds depend on the machine and on its other work; so both sides are measured in turns within one run, and what
is claimed is the ratio of their medians.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

PATIENCE_S = 3600


def interleaved(sides: dict[str, Callable[[], object]], rounds: int) -> dict[str, list[float]]:
    """Seconds of each call, the sides taking turns; each is called once beforehand to warm up."""
    for call in sides.values():
        call()
    seconds: dict[str, list[float]] = {name: [] for name in sides}
    for _ in range(rounds):
        for name, call in sides.items():
            started = time.perf_counter()
            call()
            seconds[name].append(time.perf_counter() - started)
    return seconds


def print_table(title: str, seconds: dict[str, list[float]], aims: dict[str, float] | None = None) -> None:
    """Medians and quartiles in milliseconds, and each median's ratio to the first row's."""
    print(f"{title}\n\n  {'':<44} {'median':>9} {'quartiles':>17} {'ratio':>7}  aim")
    base = None
    for name, values in seconds.items():
        low, middle, high = statistics.quantiles(values, n=4)
        base = base or middle
        aim = (aims or {}).get(name)
        verdict = "" if aim is None else f"<= {aim:g} {'met' if middle / base <= aim else 'MISSED'}"
        spread = f"{low * 1e3:.2f}..{high * 1e3:.2f}"
        print(f"  {name:<44} {middle * 1e3:>6.2f} ms {spread:>14} ms {middle / base:>6.2f}x  {verdict}")
    print()


@dataclass(frozen=True)
class Command:
    """Words, and where and how they are run; what they print goes to the file `log` there."""

    words: Sequence[str]
    folder: Path
    variables: Mapping[str, str]

    def run(self) -> None:
        """Run it; a contestant may end with 1 where a submission failed, and what counts are its scores."""
        with (self.folder / "log").open("ab") as log:
            subprocess.run(
                self.words,
                cwd=self.folder,
                env=dict(self.variables),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                timeout=PATIENCE_S,
                check=False,
            )


def cost_of(commands: Sequence[Command]) -> tuple[float, float]:
    """Seconds on the wall of commands side by side, and computing seconds of all their processes."""
    cpu, began = _children_cpu(), time.monotonic()
    with ThreadPoolExecutor(len(commands)) as threads:
        list(threads.map(Command.run, commands))
    return time.monotonic() - began, _children_cpu() - cpu


def _children_cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime

"""From the command to the verdict, and where the time goes: `python benchmarks/time_to_verdict.py`.

First whole `course-kit grade` commands, interpreter start included, beside the smallest program that could do it: a
Python that imports rclpy and ends. Then the same gradings by a worker that has just been started, as the command has
one, split into phases; and by warm workers, one for each processor, as a class is graded.
"""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from measure import interleaved

from course_kit import grading

ROOT = Path(__file__).resolve().parent.parent
ROUNDS = 7
EACH = 12  # gradings by each warm worker
PHASES = ("worker", "start", "discovery", "checks", "teardown")
AIMS_S = {"temperature_service": 1.5, "move_robot": 4.0, "robot_parameters": 4.0}
WARM_AIM_S = 0.25
FOLDERS = {"solutions": "solution", "exercises": "starter"}


def exercises() -> list[str]:
    order = [*AIMS_S, "pattern_choice"]
    return [name for name in order if (ROOT / "solutions" / name).is_dir()]


def program(folder: str, exercise: str) -> Path:
    return ROOT / folder / exercise / f"{exercise}.py"


def command(exercise: str, path: Path) -> dict[str, object]:
    """Grade in a fresh process and return its report."""
    words = [sys.executable, "-m", "course_kit", "grade", exercise, str(path), "--format", "json"]
    report: dict[str, object] = json.loads(subprocess.run(words, capture_output=True, text=True, check=False).stdout)
    return report


def phases(exercise: str, path: Path) -> dict[str, float]:
    """Median seconds of each phase, each time with a worker of its own."""
    found = [grading.grade(exercise, path).timings for _ in range(ROUNDS)]
    return {name: statistics.median(times.get(f"{name}_s", 0.0) for times in found) for name in PHASES}


def warm(exercise: str, path: Path, workers: int) -> tuple[float, float]:
    """Wall seconds a submission takes with warm workers side by side, and median seconds of one by itself."""

    def work(worker: grading.Worker) -> list[float]:
        return [grading.grade(exercise, path, worker=worker).duration_s for _ in range(EACH)]

    ready = [grading.Worker() for _ in range(workers)]
    try:
        for worker in ready:
            worker.ready()
            grading.grade(exercise, path, worker=worker)  # loads the exercise's grader
        began = time.monotonic()
        with ThreadPoolExecutor(workers) as threads:
            each = [seconds for found in threads.map(work, ready) for seconds in found]
        return (time.monotonic() - began) / len(each), statistics.median(each)
    finally:
        for worker in ready:
            worker.close()


def verdict(seconds: float, aim: float | None) -> str:
    return "" if aim is None else f"<= {aim:g} s {'met' if seconds <= aim else 'MISSED'}"


def print_commands() -> None:
    sides = {"import rclpy": lambda: subprocess.run([sys.executable, "-c", "import rclpy"], check=True)}
    aims: dict[str, float] = {}
    for exercise in exercises():
        for folder, kind in FOLDERS.items():
            path = program(folder, exercise)
            name = f"{exercise}, {kind} ({command(exercise, path)['score']:g} points)"
            sides[name] = lambda exercise=exercise, path=path: command(exercise, path)  # type: ignore[misc]
            if folder == "solutions" and exercise in AIMS_S:
                aims[name] = AIMS_S[exercise]
    print(f"Whole commands, median of {ROUNDS}\n\n  {'':<44} {'median':>8} {'quartiles':>14}  aim")
    for name, seconds in interleaved(sides, ROUNDS).items():  # type: ignore[arg-type]
        low, middle, high = statistics.quantiles(seconds, n=4)
        print(f"  {name:<44} {middle:>6.2f} s {f'{low:.2f}..{high:.2f} s':>15}  {verdict(middle, aims.get(name))}")


def print_phases() -> None:
    heads = "".join(f"{name:>11}" for name in PHASES)
    print(f"\nWhere the time goes, seconds, median of {ROUNDS}\n\n  {'':<32}{heads}{'checks are':>13}")
    for exercise in exercises():
        for folder, kind in FOLDERS.items():
            spent = phases(exercise, program(folder, exercise))
            share = spent["checks"] / (sum(spent.values()) or 1.0)
            cells = "".join(f"{seconds:>11.2f}" for seconds in spent.values())
            print(f"  {f'{exercise}, {kind}':<32}{cells}{share:>12.0%}")


def print_warm() -> None:
    workers = len(os.sched_getaffinity(0))
    print(
        f"\n{workers} warm workers side by side, {EACH} gradings each\n\n"
        f"  {'':<32}{'a submission':>14}{'one alone':>12}"
    )
    for exercise in exercises():
        wall, alone = warm(exercise, program("solutions", exercise), workers)
        aim = verdict(wall, WARM_AIM_S if exercise == "temperature_service" else None)
        print(f"  {f'{exercise}, solution':<32}{wall:>12.2f} s{alone:>10.2f} s  {aim}")


if __name__ == "__main__":
    print_commands()
    print_phases()
    print_warm()

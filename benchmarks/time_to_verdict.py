"""From the command to the verdict: `python benchmarks/time_to_verdict.py`.

Whole `course-kit grade` commands, interpreter start included, beside the smallest program that could do it: a Python
that imports rclpy and ends.
"""

from __future__ import annotations

import functools
import statistics
import subprocess
import sys
from pathlib import Path

from measure import interleaved

ROOT = Path(__file__).resolve().parent.parent
ROUNDS = 7
AIMS_S = {"temperature_service": 2.0, "move_robot": 6.0, "robot_parameters": 5.0, "pattern_choice": None}
SUBMISSIONS = {
    f"{name}, {kind}": (name, ROOT / folder / name / f"{name}.py", aim_s if kind == "solution" else None)
    for name, aim_s in AIMS_S.items()
    for folder, kind in (("solutions", "solution"), ("exercises", "starter"))
}


def run(*words: str) -> None:
    subprocess.run([sys.executable, *words], stdout=subprocess.DEVNULL, check=False)


def print_commands() -> None:
    sides = {"import rclpy": functools.partial(run, "-c", "import rclpy")}
    for title, (name, path, _) in SUBMISSIONS.items():
        sides[title] = functools.partial(run, "-m", "course_kit", "grade", name, str(path))
    print(f"Whole commands, median of {ROUNDS}\n\n  {'':<32} {'median':>8} {'quartiles':>14}  aim")
    for title, seconds in interleaved(sides, ROUNDS).items():  # type: ignore[arg-type]
        low, middle, high = statistics.quantiles(seconds, n=4)
        aim_s = SUBMISSIONS[title][2] if title in SUBMISSIONS else None
        verdict = "" if aim_s is None else f"<= {aim_s:g} s {'met' if middle <= aim_s else 'MISSED'}"
        print(f"  {title:<32} {middle:>6.2f} s {f'{low:.2f}..{high:.2f} s':>15}  {verdict}")


if __name__ == "__main__":
    print_commands()

"""From the command to the verdict: `python benchmarks/time_to_verdict.py`.

A whole `course-kit grade` each time, interpreter start included, beside the smallest program that could do it: a
Python that imports rclpy and ends.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from measure import interleaved, print_table

ROOT = Path(__file__).resolve().parent.parent
ROUNDS = 7


def grade(exercise: str, path: Path) -> dict[str, object]:
    """Grade in a fresh process and return its report."""
    command = [sys.executable, "-m", "course_kit.cli", "grade", exercise, str(path), "--format", "json"]
    report: dict[str, object] = json.loads(subprocess.run(command, capture_output=True, text=True, check=False).stdout)
    return report


def main() -> None:
    os.environ["COURSE_KIT_PROGRESS"] = "off"  # a measurement is no try of whoever takes it
    sides: dict[str, object] = {
        "import rclpy": lambda: subprocess.run([sys.executable, "-c", "import rclpy"], check=True)
    }
    for exercise in sorted(path.name for path in (ROOT / "solutions").iterdir() if path.is_dir()):
        for folder in ("solutions", "exercises"):
            path = ROOT / folder / exercise / f"{exercise}.py"
            report = grade(exercise, path)
            name = f"{exercise}, {'solution' if folder == 'solutions' else 'starter'} ({report['score']:g} points)"
            sides[name] = lambda exercise=exercise, path=path: grade(exercise, path)
    print_table("From the command to the verdict", interleaved(sides, ROUNDS))  # type: ignore[arg-type]


if __name__ == "__main__":
    main()

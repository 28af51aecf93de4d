"""Importing the kit against importing rclpy, each in a fresh interpreter: `python benchmarks/import_time.py`."""

from __future__ import annotations

import subprocess
import sys

from measure import interleaved, print_table

ROUNDS = 15


def fresh(statement: str) -> None:
    """Run one statement in a new interpreter of this environment."""
    subprocess.run([sys.executable, "-c", statement], check=True)


def main() -> None:
    sides = {
        "import rclpy": lambda: fresh("import rclpy"),
        "import rclpy, course_kit, course_kit.lab": lambda: fresh(
            "import rclpy, course_kit; from course_kit import lab"
        ),
        "import course_kit": lambda: fresh("import course_kit"),
        "pass (the interpreter alone)": lambda: fresh("pass"),
    }
    aims = {"import rclpy, course_kit, course_kit.lab": 1.3, "import course_kit": 1.3}
    print_table("Import time, interpreter included", interleaved(sides, ROUNDS), aims)


if __name__ == "__main__":
    main()

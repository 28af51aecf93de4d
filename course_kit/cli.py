"""The `course-kit` command: parses, calls one function, and renders."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


def build_parser() -> argparse.ArgumentParser:
    """The command line as argparse sees it."""
    parser = argparse.ArgumentParser(
        prog="course-kit", description="A live course on ROS 2 services, actions and parameters."
    )
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="COMMAND")

    lab = verbs.add_parser("lab", help="open the course in JupyterLab", epilog="Other options go to `jupyter lab`.")
    lab.set_defaults(run=_lab, others=[])

    grade = verbs.add_parser("grade", help="grade a solution of an exercise")
    grade.add_argument("exercise", help="the exercise's id, e.g. temperature_service")
    grade.add_argument("path", nargs="?", help="your .py or .ipynb file")
    grade.add_argument("--format", choices=("text", "json"), default="text")
    grade.add_argument("--seed", type=int, help="draw the same random values again")
    running = grade.add_mutually_exclusive_group()
    running.add_argument("--attach", action="store_true", help="grade the node that is running on the ROS graph")
    running.add_argument("--exec", dest="exec_command", metavar="CMD", help="start CMD and grade its node")
    grade.set_defaults(run=_grade)

    quiz = verbs.add_parser("quiz", help="print the answer sheet of exercise 4, a file to fill in")
    quiz.add_argument("--seed", type=int, help="the number your instructor gave you")
    quiz.set_defaults(run=_quiz)

    release = verbs.add_parser("release", help="make the student edition: the course without its answers")
    release.add_argument("target", help="a new folder, or a file that ends in .zip")
    release.set_defaults(run=_release)

    doctor = verbs.add_parser("doctor", help="say what was found on this machine and what to do about it")
    doctor.set_defaults(run=_doctor)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns:
        0 when it went well or the grade is a pass, 1 for a grade below the pass mark or a failing check of
        `doctor`, 2 when it could not be done; 130 after Ctrl-C.
    """
    parser = build_parser()
    options, others = parser.parse_known_args(arguments)
    if others and "others" not in options:
        parser.error(f"unrecognized arguments: {' '.join(others)}")
    options.others = others
    try:
        return int(options.run(options))
    except KeyboardInterrupt:
        print("\ncourse-kit: stopped.", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output has gone, as in `course-kit doctor | head`
        sys.stderr.close()
        return 0


def _lab(options: argparse.Namespace) -> int:
    from course_kit import jupyter

    return jupyter.run_lab(options.others)


def _doctor(options: argparse.Namespace) -> int:
    del options
    from course_kit import doctor

    return doctor.run()


def _release(options: argparse.Namespace) -> int:
    from course_kit import release

    return release.run(options.target)


def _quiz(options: argparse.Namespace) -> int:
    from course_kit import quiz

    print(quiz.show(quiz.DEFAULT_SEED if options.seed is None else options.seed).sheet(), end="")
    return 0


def _grade(options: argparse.Namespace) -> int:
    from course_kit import grading

    try:
        report = grading.grade(
            options.exercise,
            options.path,
            seed=options.seed,
            attach=options.attach,
            exec_command=options.exec_command,
        )
    except grading.GradingError as problem:
        print(f"course-kit: {problem}", file=sys.stderr)
        return 2
    print(report.to_json() if options.format == "json" else grading.render_text(report))
    return grading.exit_code(report)


if __name__ == "__main__":
    sys.exit(main())

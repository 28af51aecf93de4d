"""The `course-kit` command: parses, calls one function, and renders."""

from __future__ import annotations

import argparse
import io
import json
import os
import re
import sys
from datetime import datetime, timezone
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.text.console import note, refuse

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_ON_LIMITS = (
    "A submission runs sandboxed; --exec relaxes two restrictions, and --attach has no sandbox. What holds and what "
    "does not: course_kit/grading/LIMITS.md"
)
_EXERCISES = "--exercises"
_FOUND = "if left out, the kit looks in this folder, then in my-course"
_UNUSUAL = re.compile(r"[^ -~\n]")
FORMATS = ("gradescope", "classroom50")
_WISHES = ("seed", "only", "attach", "exec_command", "require_isolation")  # of `grade`, by the names of its arguments


def build_parser() -> argparse.ArgumentParser:
    """The command line as argparse sees it."""
    command = environment.course_command()
    parser = argparse.ArgumentParser(
        prog=command, description="A live course on ROS 2 services, actions and parameters."
    )
    verbs = parser.add_subparsers(dest="verb", required=True, metavar="COMMAND")
    for_instructors = find_spec("course_kit.authoring") is not None  # the student edition comes without it

    _add_folder_verbs(verbs)

    grade = verbs.add_parser("grade", help="grade a solution of an exercise", epilog=_ON_LIMITS)
    grade.add_argument("exercise", help=f"the exercise's id, as `{command} list` shows it")
    grade.add_argument("path", nargs="?", help=f"your .py or .ipynb file; {_FOUND}")
    grade.add_argument(
        "--format",
        choices=("text", "json", *(FORMATS if for_instructors else ())),
        default="text",
        help="gradescope and classroom50 are for autograders: PATH may be a folder, and exit code 0 means graded",
    )
    grade.add_argument("--to", type=Path, metavar="FILE", help="write an autograder's result to FILE, not to stdout")
    grade.add_argument("--seed", type=int, help="a number to draw other random values; else the program's text draws")
    grade.add_argument("--only", default="", metavar="PART", help="run only the checks of PART, such as door")
    grade.add_argument("--require-isolation", action="store_true", help="refuse to grade without full isolation")
    running = grade.add_mutually_exclusive_group()
    running.add_argument("--attach", action="store_true", help="grade the node that is running on the ROS graph")
    running.add_argument("--exec", dest="exec_command", metavar="CMD", help="start CMD and grade its node")
    grade.set_defaults(run=_grade)

    _add_exercise_verbs(verbs)

    quiz = verbs.add_parser("quiz", help="print ten scenarios of the quiz as a form to fill in")
    quiz.add_argument("--seed", type=int, help="the number your instructor gave you")
    quiz.set_defaults(run=_quiz)

    if for_instructors:
        from course_kit.cli import instructors

        instructors.add_to(verbs)

    doctor = verbs.add_parser("doctor", help="check this machine and suggest fixes")
    doctor.set_defaults(run=_doctor)
    for listed in verbs._choices_actions:  # noqa: SLF001 - each command's --help begins with its line in the list
        line, verb = listed.help or "", verbs.choices[listed.dest]
        verb.description = verb.description or f"{line[:1].upper()}{line[1:]}."
    parser.set_defaults(commands=verbs.choices)
    for each in _with_commands(parser):
        each.add_argument(
            _EXERCISES,
            metavar="DIR",
            help="also use the exercises in DIR, or the exercise DIR; repeatable. COURSE_EXERCISES does the same",
        )
    return parser


def _with_commands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    yield parser
    for action in parser._actions:  # noqa: SLF001 - argparse has no other way to its commands
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            for command in dict.fromkeys(action.choices.values()):  # one may have two names
                yield from _with_commands(command)


def _add_folder_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """What opens the course, and what keeps the learner's folder."""
    lab = verbs.add_parser(
        "lab",
        help="open the course in JupyterLab",
        usage=f"{environment.course_command()} lab [DIR] [OPTIONS]",
        description="Open the course in JupyterLab. DIR is your folder, made or brought up to date. Without DIR: "
        "the folder you are in, else my-course in a clone of the course, else ros2-course in your home directory.",
        epilog="OPTIONS go to `jupyter lab`.",
    )
    lab.set_defaults(run=_lab, others=[])

    copy = verbs.add_parser("copy", help="make your folder of lessons and exercises, or bring it up to date")
    copy.add_argument("path", nargs="?", type=Path, help="the folder; if left out, the one that `lab` opens")
    copy.set_defaults(run=_copy)

    hub = verbs.add_parser(
        "hub-singleuser",
        help="started by a JupyterHub for each user, as its c.Spawner.cmd",
        usage=f"{environment.course_command()} hub-singleuser [OPTIONS]",
        description="Make the user's folder of lessons, or bring it up to date; then start jupyterhub-singleuser.",
        epilog="OPTIONS go to `jupyterhub-singleuser`.",
    )
    hub.set_defaults(run=_hub, others=[])


def _add_exercise_verbs(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """What a learner does beside grading."""
    watch = verbs.add_parser("watch", help="grade a file again each time you save it")
    watch.add_argument("exercise", help="the exercise's id")
    watch.add_argument("path", nargs="?", type=Path, help=f"your file; {_FOUND}")
    watch.set_defaults(run=_watch)

    listing = verbs.add_parser("list", aliases=["progress"], help="show the exercises and your results")
    listing.add_argument("--format", choices=("text", "json"), default="text")
    listing.set_defaults(run=_list)

    drills = verbs.add_parser("drills", help="list the drills, small repairs for practice; or begin one")
    drills.add_argument("drill", nargs="?", help="the drill's id, e.g. empty_dashboard")
    drills.set_defaults(run=_drills)

    hint = verbs.add_parser("hint", help="give one more hint for what failed last")
    hint.add_argument("exercise", help="the exercise's id")
    hint.add_argument("--again", action="store_true", help="repeat the hints you have already seen")
    hint.set_defaults(run=_hint)

    tutor = verbs.add_parser(
        "tutor", help="let your AI assistant use the course's tutoring tools (Model Context Protocol)"
    )
    tutor.set_defaults(run=_tutor)

    reset = verbs.add_parser("reset", help="put an exercise's starter back, and keep your file beside it")
    reset.add_argument("exercise", help="the exercise's id")
    reset.add_argument(
        "path", nargs="?", type=Path, help=f"the file to replace, or a folder, which is made if it is missing; {_FOUND}"
    )
    reset.add_argument("--yes", action="store_true", help=argparse.SUPPRESS)  # of 0.3, which asked
    reset.add_argument("--progress", action="store_true", help="also forget its best score, tries and hints")
    reset.set_defaults(run=_reset)

    solution = verbs.add_parser("solution", help="show the solution of an exercise you have passed")
    solution.add_argument("exercise", help="the exercise's id")
    solution.add_argument("--show", action="store_true", help="for instructors: show it before you have passed")
    solution.set_defaults(run=_solution)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line."""
    environment.heed_interrupts()
    parser = build_parser()
    arguments = sys.argv[1:] if arguments is None else arguments
    folders, words = _without_folders(arguments)
    if not words:
        parser.exit(2, parser.format_help())
    if words[0] not in (commands := parser.get_default("commands")) and not words[0].startswith("-"):
        from course_kit.ros.names import did_you_mean

        meant = did_you_mean(words[0], commands)
        return refuse(f"there is no command '{words[0]}'.{meant} {environment.course_command()} --help lists them all.")
    options, others = parser.parse_known_args(words)
    if others and "others" not in options:
        parser.error(f"unrecognized arguments: {' '.join(others)}")
    options.others = others
    options.arguments = list(arguments)
    speak_to_any_terminal()
    try:
        if folders:
            from course_kit.grading.model import exercise_folders

            exercise_folders.add_exercise_folder(folders)
        code = int(options.run(options))
        sys.stdout.flush()
        return code  # noqa: TRY300 - no more can go wrong
    except KeyboardInterrupt:
        print("\ncourse-kit: stopped.", file=sys.stderr)
        return 130
    except _reasons_for_people() as problem:
        return refuse(problem)
    except BrokenPipeError:  # the reader of our output has gone, as in `course-kit doctor | head`
        sys.stderr.close()
        return 0
    except OSError as problem:
        return refuse(f"{problem.filename or 'A file'} could not be read or written: {problem.strerror or problem}.")


def _reasons_for_people() -> tuple[type[Exception], ...]:
    """Errors whose text says why it could not be done; loaded when there is one."""
    from course_kit.grading import GradingError

    return environment.DomainError, GradingError


def _without_folders(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """What `--exercises` names, and the other arguments; it may stand anywhere."""
    named: list[str] = []
    others: list[str] = []
    following = iter(arguments)
    for word in following:
        option, is_written, value = word.partition("=")
        if word == "--":
            others += [word, *following]
        elif option != _EXERCISES:
            others.append(word)
        elif is_written or (value := next(following, _EXERCISES)) != _EXERCISES:
            named.append(value)
        else:  # nothing follows: argparse says so
            others.append(word)
    return named, others


def _lab(options: argparse.Namespace) -> int:
    from course_kit.integrations import jupyter

    return jupyter.run_lab(options.others)


def _copy(options: argparse.Namespace) -> int:
    from course_kit.learner import workspace

    return workspace.copy_course(options.path)


def _hub(options: argparse.Namespace) -> int:
    from course_kit.integrations import jupyter

    return jupyter.run_on_hub(options.others)


def _doctor(_options: argparse.Namespace) -> int:
    from course_kit.cli import doctor

    return doctor.run_doctor()


def _quiz(options: argparse.Namespace) -> int:
    from course_kit import quiz

    print(quiz.show(quiz.DEFAULT_SEED if options.seed is None else options.seed).sheet(), end="")
    return 0


def _grade(options: argparse.Namespace) -> int:
    from course_kit import grading
    from course_kit.learner import progress, workspace
    from course_kit.learner.course_list import next_step
    from course_kit.text.console import wrap_text

    if options.format in FORMATS:
        return _autograde(options)
    if not options.attach:  # on stderr, beside JSON as well
        note(grading.advice_for_root())
    if options.to is not None:  # nobody waits for a file that other formats do not write
        raise grading.GradingError(f"--to is for --format {' and '.join(FORMATS)}. Redirect the output instead.")
    if not options.attach and options.exec_command is None:
        options.path, remark = workspace.choose_to_grade(options.exercise, options.path)
        note(remark)
    wishes = {name: getattr(options, name) for name in _WISHES}
    report = grading.grade(options.exercise, options.path, **wishes)
    if options.format == "json":
        print_json(report.to_json())
    else:
        print(grading.render_text(report))
    note(progress.record_report(report))
    if report.passed and not report.part and options.format != "json":
        print("\n".join(["", *wrap_text(next_step(options.exercise))]))
    return grading.exit_code(report)


def _watch(options: argparse.Namespace) -> int:
    from course_kit.learner import watch

    return watch.watch_file(options.exercise, options.path)


def _list(options: argparse.Namespace) -> int:
    from course_kit.learner import course_list

    rows, problems = course_list.list_rows()
    if options.format == "json":
        print_json(course_list.format_json(rows))
    else:
        print(course_list.format_list(rows))
    for sentence in problems:
        note(sentence)
    return 0


def _drills(options: argparse.Namespace) -> int:
    from course_kit.learner import course_list

    if options.drill is not None:
        print(course_list.begin_drill(options.drill))
        return 0
    text, problems = course_list.describe_drills()
    print(text)
    for sentence in problems:
        note(sentence)
    return 0


def _hint(options: argparse.Namespace) -> int:
    from course_kit.learner import hints

    text, trouble = hints.next_hint(options.exercise, f"{environment.course_command()} hint", again=options.again)
    print(text, end="")
    note(trouble)
    return 0


def _tutor(_options: argparse.Namespace) -> int:
    from course_kit.integrations import tutor

    return tutor.main()


def _reset(options: argparse.Namespace) -> int:
    from course_kit.learner import handouts

    return handouts.reset_exercise(options.exercise, forget=options.progress, place=options.path)


def _solution(options: argparse.Namespace) -> int:
    from course_kit.learner import handouts

    return handouts.show_solution(options.exercise, anyway=options.show)


def speak_to_any_terminal() -> None:
    """Print a question mark for a character the terminal does not have, instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def print_json(document: str) -> None:
    """JSON is UTF-8, whatever the terminal's own encoding."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding="utf-8")
    print(_UNUSUAL.sub(lambda found: found[0] if found[0].isprintable() else json.dumps(found[0])[1:-1], document))


def _autograde(options: argparse.Namespace) -> int:
    """Grade a file or folder, and print the result or write it to a file."""
    from course_kit.classroom import autograder
    from course_kit.classroom.exports import autograder_results
    from course_kit.classroom.exports.texts import json_text
    from course_kit.grading import GradingError

    if options.path is None or options.attach or options.exec_command is not None:
        raise GradingError(f"--format {options.format} grades what was handed in. Name the file or folder.")
    if options.format == "classroom50":  # before the grading: it would be for nothing
        autograder_results.require_runner(os.environ)
    record = autograder.grade_path(
        options.exercise, Path(options.path), seed=options.seed, require_isolation=options.require_isolation
    )
    if options.format == "gradescope":
        text = json_text(autograder_results.gradescope_result(record))
    else:
        text = json_text(autograder_results.classroom50_result(record, os.environ, datetime.now(timezone.utc)))
    if options.to is None:
        print_json(text)
    else:
        environment.write_atomically(options.to, f"{text}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

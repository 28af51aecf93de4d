"""The commands of those who teach with the course, or work on it: a student edition comes without them."""

from __future__ import annotations

import argparse
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.cli import class_command
from course_kit.integrations import otter
from course_kit.text.console import refuse

if TYPE_CHECKING:
    from collections.abc import Sequence

    Verbs = argparse._SubParsersAction[argparse.ArgumentParser]  # noqa: SLF001 - argparse has no other name for it

_TOOLS = ("check", "lock", "site")
_KINDS = {
    "service": "an exercise in which a node answers requests",
    "action": "one in which a node carries out goals",
    "parameters": "one in which a node is set by parameters",
    "topic": "one in which a node answers messages with messages",
}


def add_to(verbs: Verbs) -> None:
    """Add them to the command line's parser."""
    _add_release(verbs)
    class_command.add_to(verbs)
    _add_seeds(verbs)
    _add_export(verbs)
    _add_prove(verbs)
    otter.add_to(verbs)
    _add_new(verbs)
    _add_bundle(verbs)

    present = verbs.add_parser(
        "present",
        help="show a demo to a class, with your notes in a second window",
        usage=f"{environment.course_command()} present [DEMO] [OPTIONS]",
        description="Show DEMO to a class. DEMO is the number or name of a demo or lesson; if left out, demo 1.",
        epilog="OPTIONS go to `jupyter lab`.",
    )
    present.set_defaults(run=lambda options: _present(options.others), others=[])

    dev = verbs.add_parser("dev", help="for maintainers of the course: prove that its graders are right")
    dev.add_argument("tool", choices=_TOOLS)
    dev.add_argument(
        "rest", nargs=argparse.REMAINDER, help=f"its options; see {environment.course_command()} dev TOOL --help"
    )
    dev.set_defaults(run=_dev)


def _add_release(verbs: Verbs) -> None:
    release = verbs.add_parser(
        "release",
        help="make the student edition: the course without its answers",
        epilog=(
            "The command grades every program in the edition, which takes a minute or two. Exit code: 0 if the edition "
            "was made, 1 if a program in it scores more than its exercise's starter, 2 if it could not be made."
        ),
    )
    release.add_argument("target", help="a new folder, or a file that ends in .zip")
    release.add_argument(
        "--without", action="append", default=[], metavar="EXERCISE", help="leave this exercise out; repeatable"
    )
    release.add_argument("--left-out", metavar="FILE", help="write the name of every file that is left out to FILE")
    release.set_defaults(run=_release)


def _add_seeds(verbs: Verbs) -> None:
    seeds = verbs.add_parser(
        "seeds",
        help="draw a seed for each student of a roster, for class --seeds",
        epilog="Students who already have a seed in FILE keep it. Run the command again when somebody joins the class.",
    )
    seeds.add_argument("roster", type=Path, help="the class list, as for class --roster")
    seeds.add_argument("--layout", default="", help="how your platform names students; as for class")
    seeds.add_argument("--out", type=Path, metavar="FILE", help="write the list to FILE; if left out, print it")
    seeds.set_defaults(run=_seeds)


def _add_export(verbs: Verbs) -> None:
    export = verbs.add_parser("export", help="make an autograder for a platform, or reports without names")
    kinds = export.add_subparsers(dest="kind", required=True, metavar="KIND")
    gradescope = kinds.add_parser("gradescope", help="the autograder zip of an exercise for Gradescope")
    classroom50 = kinds.add_parser("classroom50", help="the autograder folder of an exercise for Classroom 50")
    for kind, what in ((gradescope, "a new .zip file"), (classroom50, "a new folder")):
        kind.add_argument("exercise", help=f"the exercise's id, as `{environment.course_command()} list` shows it")
        kind.add_argument("--to", type=Path, required=True, metavar="PATH", help=what)
        kind.add_argument(
            "--seed",
            type=int,
            help="the same values for everybody; an exercise with practice questions needs it for a grade that counts",
        )
    anonymous = kinds.add_parser("anonymous", help="the reports of a class run, under pseudonyms")
    anonymous.add_argument("results", type=Path, help="the folder that `class --out` named")
    anonymous.add_argument("--to", type=Path, required=True, metavar="DIR", help="a new folder")
    export.set_defaults(run=_export)


def _add_new(verbs: Verbs) -> None:
    new = verbs.add_parser(
        "new",
        help="make an exercise of your own, in any folder",
        epilog="course_kit/authoring/AUTHORING.md says what to do next.",
    )
    new.add_argument("what", metavar="exercise", type=_require_word, help="the word exercise")
    new.add_argument("name", help="its id: small letters, digits and _")
    kind = new.add_mutually_exclusive_group(required=True)
    for name, what in _KINDS.items():
        kind.add_argument(f"--{name}", dest="kind", action="store_const", const=name, help=what)
    kind.add_argument(
        "--refresh",
        action="store_true",
        help="copy the sentences of its exercise.toml into its starter and notebook, and the starter into the notebook",
    )
    new.add_argument(
        "--in", dest="folder", type=Path, metavar="DIR", help="the folder to make it in; the current one if left out"
    )
    new.set_defaults(run=_create_new_exercise)


def _require_word(word: str) -> str:
    if word != "exercise":
        command = environment.course_command()
        raise argparse.ArgumentTypeError(f"write `exercise` after `new`: {command} new exercise NAME --service")
    return word


def _add_bundle(verbs: Verbs) -> None:
    bundle = verbs.add_parser(
        "bundle",
        help="download every package a set-up needs, for classrooms without a network",
        description="Download all packages of a set-up into DIR. `./course lab --find-links DIR` then sets the course "
        "up without a network, on any x86-64 Linux.",
    )
    bundle.add_argument("folder", type=Path, metavar="DIR", help="the folder, made if missing; its files stay")
    bundle.add_argument(
        "--python",
        action="append",
        metavar="VERSION",
        help="the Python of the classroom, such as 3.12, or `all`; repeatable. If left out, this Python",
    )
    bundle.add_argument("--test", action="store_true", help="also download what ./course test needs")
    bundle.set_defaults(run=_bundle)


def _release(options: argparse.Namespace) -> int:
    from course_kit.authoring import release

    return release.release_edition(options.target, options.without, options.left_out)


def _seeds(options: argparse.Namespace) -> int:
    from course_kit.classroom.exports.texts import csv_text
    from course_kit.classroom.rules import seeds

    before = seeds.read_seeds(options.out) if options.out and options.out.exists() else None
    drawn = seeds.draw_seeds(seeds.students_of(options.roster, options.layout), before)
    text = csv_text([seeds.COLUMNS, *((student, seed) for student, seed in drawn.items())])
    if options.out:
        environment.write_atomically(options.out, text)
    else:
        sys.stdout.write(text)
    return 0


def _export(options: argparse.Namespace) -> int:
    from course_kit.authoring import autograders
    from course_kit.classroom.exports import anonymous
    from course_kit.classroom.run import stored_gradebook

    if options.kind == "anonymous":
        path = anonymous.write_anonymous_pages(stored_gradebook(options.results), options.to)
        then = "reports and scores under pseudonyms."
    elif options.kind == "gradescope":
        path = autograders.write_gradescope(options.exercise, options.to, options.seed)
        then = "upload it under Configure Autograder; choose a base image of Ubuntu 22.04 or newer."
    else:
        path = autograders.write_classroom50(options.exercise, options.to, options.seed)
        then = (
            "put what is in it into CLASSROOM/autograders/ASSIGNMENT of your classroom50 repository, but "
            "runtime.json, which is for `gh teacher assignment add --runtime`."
        )
    print(f"{path}: {then}")
    return 0


def _create_new_exercise(options: argparse.Namespace) -> int:
    from course_kit.authoring import new_exercise
    from course_kit.learner.workspace import shorten_path

    if options.refresh:
        return _refresh(options)
    exercise = new_exercise.create_exercise(options.name, options.kind, options.folder or Path.cwd())
    folder, program = (shlex.quote(str(shorten_path(path))) for path in (exercise.folder, exercise.solution))
    command = environment.course_command()
    there = "" if options.folder is None else f" --in {shlex.quote(str(options.folder))}"
    print(f"The exercise {exercise.id} is in {folder}. It works as it is:")
    print(f"  {command} grade {exercise.id} {program} --exercises {folder}")
    print("Change exercise.toml, the starter and the solution into your own exercise; after a change of the task:")
    print(f"  {command} new exercise {exercise.id} --refresh{there}")
    print("The guide is course_kit/authoring/AUTHORING.md.")
    return 0


def _refresh(options: argparse.Namespace) -> int:
    from course_kit.authoring import new_exercise
    from course_kit.grading.model.exercise import load_exercise, read_exercise
    from course_kit.grading.model.exercise_folders import TOML
    from course_kit.learner.workspace import shorten_path

    folder = (options.folder or Path.cwd()) / options.name
    exercise = read_exercise(folder) if (folder / TOML).is_file() else load_exercise(options.name)
    changed = new_exercise.refresh_exercise(exercise)
    for path in changed:
        print(shorten_path(path))
    if not changed:
        print(f"The starter and the notebook of {exercise.id} are as its exercise.toml says.")
    return 0


def _bundle(options: argparse.Namespace) -> int:
    from course_kit.authoring import wheel_bundle
    from course_kit.dev import lock

    root = environment.checkout_folder()
    if root is None:
        return refuse("the list of packages belongs to the course's folder; run this in a clone of it.")
    wheel_bundle.make_bundle(root, options.python, lock.PYTHONS, options.folder.absolute(), tests=options.test)
    return 0


def _present(words: Sequence[str]) -> int:
    """Present the demo that is the first word if that is no option; the others are options of `jupyter lab`."""
    from course_kit.presentation import session

    root = environment.course_files()
    if root is None:
        return refuse("the demos are missing. Run ./course present in the course's folder.")
    named = next((count for count, word in enumerate(words) if word.startswith("-")), len(words))
    if named > 1:
        return refuse(f"present shows one demo, and these are {named}: {' '.join(words[:named])}. Name one of them.")
    return session.present_notebook(root, "".join(words[:named]), words[named:])


def _dev(options: argparse.Namespace) -> int:
    from course_kit.authoring import check
    from course_kit.dev import lock
    from course_kit.dev.site import command as site

    mains = (check.main, lock.main, site.main)
    return dict(zip(_TOOLS, mains, strict=True))[options.tool](options.rest)


def _add_prove(verbs: Verbs) -> None:
    parser = verbs.add_parser(
        "prove",
        help="find out what the grader of an exercise lets through",
        description="Make every small mistake in the solution, grade each, and print those that get full marks.",
        epilog="Exit code: 0 if nothing was found, 1 if something was, 2 if it failed, 130 if it was stopped. Declare "
        "mistakes that change nothing in equivalent.toml: see course_kit/authoring/AUTHORING.md.",
    )
    parser.add_argument("exercise", metavar="EXERCISE")
    parser.add_argument("--quick", action="store_true", help="a sample of the mistakes, with one seed")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="the seed of the checks' random values (1)")
    parser.add_argument(
        "--workers", type=int, metavar="N", help="number of gradings at once (default: what suits this machine)"
    )
    parser.set_defaults(run=_prove)


def _prove(options: argparse.Namespace) -> int:
    from course_kit.authoring.prove import proving
    from course_kit.grading.model.exercise import load_exercise

    exercise = load_exercise(options.exercise)
    proof = proving.prove_grader(exercise, quick=options.quick, seed=options.seed, workers=options.workers)
    print("\n".join(proving.describe_proof(proof, quick=options.quick)))
    return 0 if proof.holds else 1

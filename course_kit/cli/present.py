"""`course-kit present`: a demo in front of a class."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.integrations.jupyter import LabStartError
from course_kit.text.console import cannot

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence


def add_to(verbs: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """Add it to the command line's parser."""
    present = verbs.add_parser(
        "present",
        help="show a demo to a class, with your notes in a second window",
        usage="course-kit present [DEMO] [OPTIONS]",
        description="DEMO is the number or the name of a demo, or of a lesson; the first demo when left out.",
        epilog="OPTIONS go to `jupyter lab`.",
    )
    present.set_defaults(run=lambda options: run(options.others), others=[])


def run(words: Sequence[str]) -> int:
    """Present a demo until the speaker ends it.

    Args:
        words: the demo if the first is no option, then options of `jupyter lab`.

    Returns:
        0 after Ctrl-C; 2 if it could not begin.
    """
    from course_kit.presentation import session
    from course_kit.presentation.errors import PresentationError

    root = environment.course_files()
    if root is None:
        return cannot("the demos are missing. Run ./course present in the course's folder.")
    named = next((count for count, word in enumerate(words) if word.startswith("-")), len(words))
    if named > 1:
        return cannot(f"present shows one demo, and these are {named}: {' '.join(words[:named])}. Name one of them.")
    try:
        return session.present(root, "".join(words[:named]), words[named:])
    except (PresentationError, LabStartError) as problem:
        return cannot(problem)

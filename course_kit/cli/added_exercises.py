"""`--exercises DIR`, an option of every command: exercises that lie outside of the course's folder."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_OPTION = "--exercises"


def describe_in(parser: argparse.ArgumentParser) -> None:
    """Have the help of each command tell of the option."""
    for one in _with_commands(parser):
        one.add_argument(
            _OPTION,
            metavar="DIR",
            help="add the exercises in DIR, or the one that DIR is; may be repeated; COURSE_EXERCISES does the same",
        )


def taken_out(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """What the option names, and the other arguments; it may stand anywhere.

    argparse would not find an EXERCISE or FILE behind it where they can be left out.
    """
    named: list[str] = []
    others: list[str] = []
    following = iter(arguments)
    for word in following:
        option, is_written, value = word.partition("=")
        if word == "--":
            others += [word, *following]
        elif option != _OPTION:
            others.append(word)
        elif is_written or (value := next(following, _OPTION)) != _OPTION:
            named.append(value)
        else:  # nothing follows: argparse says so
            others.append(word)
    return named, others


def _with_commands(parser: argparse.ArgumentParser) -> Iterator[argparse.ArgumentParser]:
    yield parser
    for action in parser._actions:  # noqa: SLF001 - argparse has no other way to its commands
        if isinstance(action, argparse._SubParsersAction):  # noqa: SLF001
            for command in action.choices.values():
                yield from _with_commands(command)

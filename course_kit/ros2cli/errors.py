"""What goes wrong, in one line, with the nearest right name."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class CommandError(Exception):
    """A verb cannot do what was asked; the message is the one line that goes to stderr.

    Attributes:
        exit_code: what the process ends with; 1 as the real command does unless recorded otherwise.
    """

    def __init__(self, message: str, exit_code: int = 1) -> None:
        super().__init__(" ".join(message.split()))
        self.exit_code = exit_code


def did_you_mean(name: str, names: Iterable[str]) -> str:
    """' Did you mean ...?' with the nearest of `names`, or '' when none is near; ready to be appended."""
    from difflib import get_close_matches

    candidates = sorted(set(names) - {name})
    near = get_close_matches(name, candidates, n=1, cutoff=0.5)
    if not near:  # the last part alone: /ad_two_ints for /robot/add_two_ints
        by_tail = {candidate.rsplit("/", 1)[-1]: candidate for candidate in candidates}
        near = [by_tail[tail] for tail in get_close_matches(name.rsplit("/", 1)[-1], by_tail, n=1, cutoff=0.6)]
    return f" Did you mean {near[0]}?" if near else ""

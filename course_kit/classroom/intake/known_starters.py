"""All starters that the course ever gave out: whoever hands one in as it was has not begun with the exercise.

`known_starters.json` is written by `python -m course_kit.authoring.shipped_starters` out of git's history: an old
starter comes back from those who cloned the course a year ago.
"""

from __future__ import annotations

import json
from pathlib import Path

FILE = Path(__file__).with_name("known_starters.json")


def read(path: Path = FILE) -> dict[str, frozenset[str]]:
    """For each exercise the identities of its starters, see `course_kit.reader.fingerprints.identity`.

    Args:
        path: the list's file.
    """
    table = json.loads(path.read_text(encoding="utf-8"))
    return {str(name): frozenset(map(str, identities)) for name, identities in table.items()}

"""Whose a course's folder is."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.unprivileged import as_somebody, forbid_writing, give, reachable_folder

ASK = """
import sys
from pathlib import Path
from course_kit import environment
print(environment.paths.is_shared(Path(sys.argv[1])))
"""


@pytest.mark.parametrize(
    ("there", "read_only", "shared"),
    [
        (("notebooks", "exercises"), (), False),
        (("notebooks", "exercises"), ("exercises",), True),
        (("notebooks", "exercises"), ("notebooks", "exercises"), True),
        (("notebooks",), (), False),  # an edition without exercises
    ],
)
def test_a_course_is_shared_where_a_learner_could_not_save_in_it(
    there: tuple[str, ...], read_only: tuple[str, ...], shared: bool
) -> None:
    with reachable_folder() as root:
        for name in there:
            (root / name).mkdir()
        give(root)
        for name in read_only:
            forbid_writing(root / name)
        asked = subprocess.run(
            as_somebody(sys.executable, "-c", ASK, str(root)), capture_output=True, text=True, timeout=60, check=True
        )
        for name in read_only:
            forbid_writing(root / name, forbid=False)
    assert asked.stdout == f"{shared}\n"

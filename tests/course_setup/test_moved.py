"""A course folder that has been moved or copied is set up again, whatever it is called."""

from __future__ import annotations

import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from tests.course_clone import Clone

if TYPE_CHECKING:
    from pathlib import Path

ODD_NAMES = ['it\'s [a] "course" * $HOME & 100% \\', "Übung 🤖"]


def ask(clone: Clone, shell_command: str) -> str:
    done = subprocess.run(
        ["/bin/sh", "-c", shell_command],
        cwd=clone.root.parent,
        env=clone.environ(),
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.rstrip("\n")


def in_shell(path: Path) -> str:
    return "'" + str(path).replace("'", "'\\''") + "'"


@pytest.mark.parametrize("name", ODD_NAMES)
def test_everything_in_its_environment_finds_itself(tmp_path: Path, name: str) -> None:
    clone = Clone(tmp_path, name)
    place = "import sys; print(sys.prefix)"
    for _ in range(2):
        assert clone.course("doctor", cwd=tmp_path).stdout == f"cli {clone.environment} doctor\n"
        face = in_shell(clone.root / ".venv")
        assert ask(clone, f"{face}/bin/program") == f"program {clone.environment}"
        assert ask(clone, f"{face}/bin/python -c '{place}'") == f"{clone.root}/.venv"
        of_kit = "import course_kit; print(course_kit.__file__)"
        assert ask(clone, f"{face}/bin/python -c '{of_kit}'") == f"{clone.root}/course_kit/__init__.py"
        clone.root = clone.root.rename(clone.root.with_name(f"moved {name}"))


def test_a_copy_has_nothing_to_do_with_the_original(clone: Clone, tmp_path: Path) -> None:
    clone.course("doctor")
    original = clone.root
    shutil.copytree(original, tmp_path / "a copy", symlinks=True)
    clone.root = tmp_path / "a copy"
    (original / "course_kit" / "cli" / "main.py").write_text("print('the original')\n")
    assert clone.course("doctor", cwd=tmp_path).stdout == f"cli {clone.environment} doctor\n"
    assert clone.environment.is_relative_to(tmp_path / "a copy")

"""What an author declares as equivalent: which mutants an entry is about, and what is said of a wrong entry."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.authoring.prove import proving
from course_kit.grading import GradingError

if TYPE_CHECKING:
    from pathlib import Path

SOURCE = "def a():\n    return b + 1\n\n\ndef c():\n    return b + 1\n"
LINES = 'lines = ["return b + 1"]\n'
OPERATORS = 'operators = ["another number"]\n'
REASON = 'reason = "It does not matter."\n'


def covered(tmp_path: Path, *more: str) -> list[str]:
    path = tmp_path / "equivalent.toml"
    path.write_text("[[equivalent]]\n" + LINES + OPERATORS + REASON + "".join(f"{line}\n" for line in more))
    entries = proving.read_equivalents(path)
    return [one.key for one in proving.make_mutants(SOURCE) if any(entry.covers(one) for entry in entries)]


def test_an_entry_is_about_an_operator_on_a_line_wherever_it_stands(tmp_path: Path) -> None:
    two, none = "another number: return b + 1: 1 -> 2", "another number: return b + 1: 1 -> 0"
    assert covered(tmp_path) == [two, none, f"{two} (no. 2)", f"{none} (no. 2)"]
    assert covered(tmp_path, 'change = "-> 2"') == [two, f"{two} (no. 2)"]
    assert covered(tmp_path, 'change = "-> 2"', "ordinal = 2") == [f"{two} (no. 2)"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[[equivalent]\n", "cannot be used"),
        ("[other]\n", "cannot be used: Expected `array`, got `object`"),
        ("equivalent = 3\n", "Expected `array`, got `int`"),
        (f"[[equivalent]]\n{LINES}{OPERATORS}", "missing required field `reason` - at `entry 1`"),
        (f"[[equivalent]]\n{LINES}{OPERATORS}{REASON}why = 1\n", "unknown field `why` - at `entry 1`"),
        (
            f'[[equivalent]]\nlines = "a"\n{OPERATORS}{REASON}',
            r"Expected `array`, got `str` - at `entry 1\.lines`",
        ),
    ],
)
def test_a_wrong_entry_is_named(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "equivalent.toml"
    path.write_text(text)
    with pytest.raises(GradingError, match=said):
        proving.read_equivalents(path)


@pytest.mark.parametrize("name", ["temperature_service", "move_robot", "robot_parameters"])
def test_each_declaration_of_the_course_is_about_a_mutant_that_there_is(name: str) -> None:
    root = environment.checkout_folder()
    assert root is not None
    folder = root / "solutions" / name
    made = proving.make_mutants((folder / f"{name}.py").read_text(), starts_itself=False)
    entries = proving.read_equivalents(folder / proving.FILE)
    assert entries
    assert [str(one) for one in entries if not any(one.covers(mutant) for mutant in made)] == []

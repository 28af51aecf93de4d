"""What an exercise.toml says of the sentences of its task is read and checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from course_kit.grading.errors import GradingError
from course_kit.grading.model.exercise import Sentence, read_exercise
from tests import outside_exercises

if TYPE_CHECKING:
    from pathlib import Path

    from course_kit.grading.model.exercise import Exercise


def read(toml: str, folder: Path) -> Exercise:
    made = outside_exercises.write(folder)
    with (made / "exercise.toml").open("a") as file:
        file.write(f"\n{toml}\n")
    return read_exercise(made)


def test_sentences_are_read_with_all_their_fields(tmp_path: Path) -> None:
    more = 'heading = "Queues."\ncell = "task"\nfreedom = "shallow"'
    exercise = read(f'[[sentences]]\nid = "depth"\ntext = " Any depth will do. "\n{more}', tmp_path)
    assert exercise.sentences[-1] == Sentence("depth", "Any depth will do.", "Queues.", "task", "shallow")


@pytest.mark.parametrize(
    ("toml", "said"),
    [
        ('[[sentences]]\nid = "a"\ntext = 3', "cannot be right: expected str, got int"),
        ('[[sentences]]\ntext = "A."', "'id' is missing in sentences"),
        ('[[sentences]]\nid = "A b"\ntext = "A."', "matching regex"),
        ('[[sentences]]\nid = "a"\ntext = " "', "cannot be right"),
        ('[[sentences]]\nid = "a"\ntext = "A."\ntxt = "B."', "no setting 'txt' in sentences"),
        ('[[sentences]]\nid = "a"\ntext = "A."\n[[sentences]]\nid = "a"\ntext = "B."', "two sentences have the id 'a'"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_its_cause(toml: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(GradingError, match=said):
        read(toml, tmp_path)

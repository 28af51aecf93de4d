"""What was read while a file was looked at is not read again, and is what reading it would tell."""

from __future__ import annotations

from pathlib import Path

import pytest

from course_kit.grading.model.exercise import load_exercise
from course_kit.grading.model.submission import Copy
from course_kit.grading.reading import readings
from course_kit.grading.reading.reader import Reader, ReadingStoppedError

EXERCISE = load_exercise("temperature_service")
CHOICE = load_exercise("pattern_choice")
SOLUTION = (Path(__file__).parents[2] / "solutions/temperature_service/temperature_service.py").read_text(
    encoding="utf-8"
)
BROKEN = f"{SOLUTION}\ndef (\n"


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What a reader's children were asked for, as it grows."""
    told: list[str] = []

    class RecordingReader(Reader):
        def _exchange(self, request: dict[str, object], copy: Copy) -> tuple[dict[str, object], bytes]:
            told.append("any" if request["whatever"] else "asked for")
            return super()._exchange(request, copy)

    monkeypatch.setattr(readings, "Reader", RecordingReader)
    return told


@pytest.mark.parametrize("text", [SOLUTION, BROKEN], ids=["right", "no Python"])
def test_a_submission_is_read_while_it_is_looked_at(text: str, tmp_path: Path, asked: list[str]) -> None:
    path = tmp_path / "answer.py"
    path.write_text(text)
    with Copy(path) as copy, Reader() as reader:
        due = reader.read(copy, EXERCISE), reader.look(copy, EXERCISE, whatever=True).fingerprints
    with readings.Readings() as known, Copy(path) as copy:
        assert known.glance(copy, EXERCISE).asked_for
        assert (known.read(copy, EXERCISE), known.fingerprints(copy, EXERCISE)) == due
    with known.remembered() as again, Copy(path) as copy:
        assert (again.read(copy, EXERCISE), again.fingerprints(copy, EXERCISE)) == due
    assert asked == ["asked for"]


def test_another_name_text_or_exercise_is_another_reading(tmp_path: Path, asked: list[str]) -> None:
    first, second, changed = (tmp_path / name for name in ("first.py", "second.py", "changed.py"))
    for path in (first, second, changed):
        path.write_text(SOLUTION)
    with readings.Readings() as known:
        with Copy(first) as copy, Copy(changed) as before:
            known.glance(copy, EXERCISE)
            known.glance(before, EXERCISE)
            assert known.read(copy, CHOICE).name == "first.py"
        changed.write_text("answers = {}\n")
        with Copy(second) as copy, Copy(changed) as after:
            assert known.read(copy, EXERCISE).name == "second.py"
            assert known.read(after, EXERCISE).source == "answers = {}\n"
    assert asked == ["asked for", "asked for", "any", "any", "any"]


@pytest.mark.parametrize("text", ["x = 1\n", ""], ids=["something else", "nothing"])
def test_what_is_not_asked_for_is_not_remembered(text: str, tmp_path: Path, asked: list[str]) -> None:
    path = tmp_path / "answer.py"
    path.write_text(text)
    with readings.Readings() as known, Copy(path) as copy:
        assert not known.glance(copy, EXERCISE).asked_for
        known.fingerprints(copy, EXERCISE)
    assert asked == ["asked for", "any"]


def test_a_class_may_be_larger_than_what_is_remembered(
    tmp_path: Path, asked: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(readings, "_MOST_CHARACTERS", 1)
    with readings.Readings() as known:
        for name in ("first.py", "second.py"):
            (tmp_path / name).write_text(SOLUTION)
            with Copy(tmp_path / name) as copy:
                known.glance(copy, EXERCISE)
                assert known.read(copy, EXERCISE).source == SOLUTION
    assert asked == ["asked for", "asked for", "any"]


def test_what_was_stopped_does_not_stop_who_remembers_it(tmp_path: Path) -> None:
    path = tmp_path / "answer.py"
    path.write_text(SOLUTION)
    with readings.Readings(lambda: True) as known, Copy(path) as copy:
        with pytest.raises(ReadingStoppedError):
            known.read(copy, EXERCISE)
        with known.remembered() as other:
            assert other.read(copy, EXERCISE).source == SOLUTION

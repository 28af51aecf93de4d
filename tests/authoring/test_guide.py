"""The authoring guide is as true as the kit: the exercise that it begins with, its commands, its tables of checks."""

from __future__ import annotations

import re
import shlex
import shutil
from pathlib import Path

import pytest

from course_kit import environment, grading
from course_kit.authoring import check, new_exercise
from course_kit.cli import main as cli
from course_kit.grading.checks import vocabulary
from course_kit.grading.model.exercise import read_exercise
from course_kit.grading.model.exercise_folders import VARIABLE

TEXT = (environment.PACKAGE / "authoring" / "AUTHORING.md").read_text(encoding="utf-8")
MOST_WORDS = 2200


def blocks(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, re.MULTILINE | re.DOTALL)


@pytest.mark.weekly
@pytest.mark.answers
def test_a_counter_that_was_made_from_the_guide_alone_proves_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By somebody who had not seen the kit: a number, a step that is a parameter, a reset that is refused at 0."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    made = new_exercise.create_exercise("counter", "service", tmp_path).folder
    shutil.rmtree(made / "proof")
    shutil.copytree(Path(__file__).parent / "counter", made, dirs_exist_ok=True)
    new_exercise.refresh_exercise(read_exercise(made))
    found = check.check_proofs(environment.checkout_folder() or Path(), ["counter"])
    assert [str(one) for one in found.faults] == []


@pytest.mark.answers
def test_its_first_page_is_an_exercise_that_proves_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Really graded; then its solution once more, by the check of one's own that comes later in the guide."""
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    made = new_exercise.create_exercise("battery_monitor", "topic", tmp_path).folder
    toml, slips, *_ = blocks("toml")
    checks, solution, own = blocks("python")
    (made / "exercise.toml").write_text(toml)
    (made / "checks.py").write_text(checks)
    (made / "solution" / "battery_monitor.py").write_text(solution)
    (made / "proof" / "slips.toml").write_text(slips)
    for name in ("correct", "broken"):
        shutil.rmtree(made / "proof" / name)
    new_exercise.refresh_exercise(read_exercise(made))
    found = check.check_proofs(environment.checkout_folder() or Path(), ["battery_monitor"])
    assert [str(one) for one in found.faults] == []
    (made / "exercise.toml").write_text(toml.replace("points = 5.0", "points = 6.0"))
    (made / "checks.py").write_text(f"{checks}\n{own}\nCHECKS.append(reset_waits)\n")
    report = grading.grade("battery_monitor", made / "solution" / "battery_monitor.py", exercises=tmp_path)
    assert report.score == 6.0, report


def test_it_names_each_ready_made_check_and_is_short() -> None:
    told = set(re.findall(r"^\| `(\w+)` \|", TEXT, re.MULTILINE))
    ready_made = {name for name in dir(vocabulary) if name.startswith(("service_", "topic_", "parameter_", "goal_"))}
    assert told == {"endpoints_offered", "node_name", *ready_made}
    assert len(TEXT.split()) <= MOST_WORDS


def test_its_commands_are_those_there_are() -> None:
    parser = cli.build_parser()
    verbs = re.search(r"\{([\w,]+)\}", parser.format_usage())
    known = set(re.findall(r"^    (\w+)", parser.format_help(), re.MULTILINE))
    named = [shlex.split(line)[1] for line in TEXT.splitlines() if line.startswith("./course ")]
    assert len(named) > 6
    assert set(named) <= known | (set(verbs[1].split(",")) if verbs else set())

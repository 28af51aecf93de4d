"""Attacks under each kind of isolation that this machine can show."""

from __future__ import annotations

import os
import secrets
import socket
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.grading.sandbox import attack_modes
from tests.grading.sandbox.attacks import ATTACKS, SECRET_OF_A_STUDENT

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.grading.model.job import Isolation


BEFORE = "of a student graded before"
USUAL = (attack_modes.USER,)
MODES = [
    pytest.param(mode, marks=[] if mode in USUAL else pytest.mark.weekly)
    for mode in (*attack_modes.OF_USER, *(attack_modes.OF_ROOT if os.getuid() == 0 else ()))
]


class Outcomes(dict[str, dict[str, Any]]):
    """By mode, once it is asked for: the isolation, and by attack its outcome."""

    def __init__(self, programs: dict[str, str]) -> None:
        super().__init__()
        self._programs = programs

    def __missing__(self, mode: str) -> dict[str, Any]:
        self[mode] = attack_modes.outcomes(mode, self._programs)
        return self[mode]


@pytest.fixture(scope="module")
def outcomes() -> Iterator[Outcomes]:
    with ExitStack() as stack:
        # Not pytest's folder, which is private: what every user may read has to be safe.
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        yield Outcomes(prepared(stack, Path(folder)))


def prepared(stack: ExitStack, folder: Path) -> dict[str, str]:
    """The attacks, with what they attack in place."""
    folder.chmod(0o755)
    victim = folder / "of_another_student.py"
    victim.write_text(SECRET_OF_A_STUDENT)
    if os.getuid() == 0:  # as an ordinary user's it can be changed by a program of that user's
        os.chown(victim, attack_modes.NOBODY, attack_modes.NOBODY)
    name = f"course-kit-{secrets.token_hex(8)}"
    by_file, by_name = (stack.enter_context(socket.socket(socket.AF_UNIX)) for _ in range(2))
    by_file.bind(str(folder / "socket"))
    (folder / "socket").chmod(0o777)
    by_name.bind(f"\0{name}")
    tcp = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
    for server in (by_file, by_name):
        server.listen()
    values = {"%FILE%": str(victim), "%SOCKET%": str(folder / "socket"), "%NAME%": name, "%PORT%": tcp.getsockname()[1]}
    programs = {BEFORE: f"text = '{SECRET_OF_A_STUDENT}'\n"}
    for attack, described in ATTACKS.items():
        source = described.source
        for place, value in values.items():
            source = source.replace(place, repr(value))
        programs[attack] = source
    return programs


@pytest.mark.timeout(400)
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("attack", ATTACKS)
def test_attack_is_held_or_admitted(attack: str, mode: str, outcomes: Outcomes) -> None:
    found: Isolation = outcomes[mode]["isolation"]
    outcome = outcomes[mode][attack]
    assert not outcome["problem"]
    won = [line for line in outcome["stdout"].splitlines() if line.startswith("WON")]
    admitted = ATTACKS[attack].admitted
    if won:  # only where LIMITS.md says so: something that would hold it is not to be had there
        assert admitted, won
        assert not any(getattr(found, kind) for kind in admitted), won
    if found.is_full:
        assert not won
        assert {result["status"] for result in outcome["results"]} <= {"failed", "skipped"}


@pytest.mark.timeout(400)
@pytest.mark.parametrize("mode", MODES)
def test_a_program_that_only_ends_is_over_no_limit(mode: str, outcomes: Outcomes) -> None:
    """While a process ends, its descriptors can be seen by root alone, as those of one that hides."""
    ended = [BEFORE, "lends_its_output", "reads_a_file", "makes_strange_sockets"]
    found = {name: outcomes[mode][name]["results"][0]["diagnosis"] for name in ended}
    assert not any(diagnosis.startswith("limit") for diagnosis in found.values()), found


def test_everything_is_isolated_where_namespaces_are_allowed(outcomes: Outcomes) -> None:
    """Without it the rows above would show little."""
    restricted = Path("/proc/sys/kernel/apparmor_restrict_unprivileged_userns")
    if restricted.exists() and restricted.read_text().strip() == "1":
        assert outcomes[attack_modes.USER]["isolation"].reason
        return
    assert outcomes[attack_modes.USER]["isolation"].is_full, outcomes[attack_modes.USER]["isolation"].describe()

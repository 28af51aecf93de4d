"""What the machine tells of its processors and its memory."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest

from course_kit.grading.sandbox import machine

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(autouse=True)
def fresh() -> Iterator[None]:
    machine.processor_share.cache_clear()
    yield
    machine.processor_share.cache_clear()


def test_what_this_process_computes_is_among_what_the_processors_have_done() -> None:
    before, begun = machine.processors_worked(), time.process_time()
    while time.process_time() - begun < 0.5:
        pass
    after = machine.processors_worked()
    assert after - before > 0.4  # it is counted in ticks


@pytest.mark.parametrize(
    ("groups", "files", "share"),
    [
        ("0::/\n", {}, 1.0),
        ("0::/\n", {"cpu.max": "50000 100000\n"}, 0.5),
        ("0::/\n", {"cpu.max": "max 100000\n"}, 1.0),
        ("0::/\n", {"cpu.max": "400000 100000\n"}, 1.0),
        ("0::/a/b\n", {"a/cpu.max": "20000 100000\n", "a/b/cpu.max": "max 100000\n"}, 0.2),
        ("nonsense\n", {"cpu.max": "nonsense\n"}, 1.0),
    ],
)
def test_a_container_may_be_held_to_less_than_a_processor(
    groups: str, files: dict[str, str], share: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own").write_text(groups)
    root = tmp_path / "cgroup"
    for name, text in files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    monkeypatch.setattr(machine, "_CGROUPS", root)
    monkeypatch.setattr(machine, "_OWN_GROUPS", tmp_path / "own")
    assert machine.processor_share() == share


def test_this_machine_gives_a_thread_a_processor_or_a_part_of_it() -> None:
    assert 0.0 < machine.processor_share() <= 1.0


@pytest.mark.parametrize(
    ("files", "free"),
    [
        ({}, 4096),
        ({"memory.max": "max\n", "memory.current": "700\n"}, 4096),
        ({"memory.max": "1000\n", "memory.current": "700\n"}, 300),
        ({"memory.max": "600\n", "memory.current": "700\n"}, 0),
    ],
)
def test_memory_is_what_is_available_and_what_a_container_may_have(
    files: dict[str, str], free: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "own").write_text("0::/\n")
    (tmp_path / "meminfo").write_text("MemTotal:  9 kB\nMemAvailable:  4 kB\n")
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path)
    monkeypatch.setattr(machine, "_OWN_GROUPS", tmp_path / "own")
    monkeypatch.setattr(machine, "_MEMORY", tmp_path / "meminfo")
    assert machine.free_memory() == free


def test_memory_that_nobody_tells_of_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "_OWN_GROUPS", tmp_path / "none")
    monkeypatch.setattr(machine, "_MEMORY", tmp_path / "none")
    assert machine.free_memory() == 0

"""A class run that is killed, or has no room on its disk: in the end the grades are those of a clean run."""

from __future__ import annotations

import json
import math
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from course_kit import environment
from course_kit.grading import isolation_status

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).resolve().parent.parent.parent
EXERCISE = "pattern_choice"  # the one that is graded fastest
RIGHT = (ROOT / f"solutions/{EXERCISE}/{EXERCISE}.py").read_text()
KILLS = int(os.environ.get("COURSE_RUN_KILLS", "20"))
SIZE = 5
PATIENCE_S = 100.0  # against hanging only
pytestmark = [pytest.mark.answers, pytest.mark.timeout(600)]


def hand_in(inbox: Path, number: int, version: int) -> None:
    """Some are right and some wrong, each in its own text, so that each is graded."""
    text = RIGHT.replace('"service"', '"topic"') if (number + version) % 2 else RIGHT
    folder = inbox / f"student{number}"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{EXERCISE}.py").write_text(f"{text}\n# {number}, version {version}\n")


@pytest.fixture
def inbox(tmp_path: Path) -> Path:
    for number in range(SIZE):
        hand_in(tmp_path / "in", number, 0)
    return tmp_path / "in"


def command(inbox: Path, out: Path, *more: str) -> list[str]:
    words = ["class", str(inbox), "--exercise", EXERCISE, "--out", str(out), "--workers", "2", *more]
    return [sys.executable, "-m", "course_kit", *words]


def finish(inbox: Path, out: Path, *more: str) -> str:
    done = subprocess.run(command(inbox, out, *more), capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stderr


def grades(out: Path) -> dict[str, bytes]:
    """What people and platforms read, and what each check found; not how long it took."""
    texts = {path: (out / path).read_bytes() for path in ("grades.csv", "exports/canvas.csv", "exports/nbgrader.csv")}
    for path in sorted(out.glob("students/*/*.json")):
        report = json.loads(path.read_text())["report"]
        checks = {check["id"]: check["status"] for check in report["checks"]}
        texts[str(path.relative_to(out))] = json.dumps([report["score"], report["status"], checks]).encode()
    return texts


def pages(out: Path) -> set[str]:
    return {str(path.relative_to(out)) for path in out.glob("students/*/*") if not path.name.startswith(".")}


def change(inbox: Path, version: int, chance: random.Random) -> None:
    """Somebody hands in anew, somebody withdraws, somebody who had withdrawn hands in again."""
    hand_in(inbox, chance.randrange(SIZE), version)
    who = chance.randrange(SIZE, SIZE + 3)
    if (inbox / f"student{who}").exists():
        shutil.rmtree(inbox / f"student{who}")
    else:
        hand_in(inbox, who, version)


def test_killed_at_twenty_random_moments_while_the_inbox_changes(inbox: Path, tmp_path: Path) -> None:
    """Each kill comes somewhere between the beginning of the program and the end of its exports."""
    out, chance = tmp_path / "out", random.Random(13)  # noqa: S311 - moments, not secrets
    usual = duration(lambda: finish(inbox, tmp_path / "measured"))
    cut_short = 0
    for kill in range(KILLS):
        run = subprocess.Popen(command(inbox, out, "--resume"), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            run.wait(chance.uniform(0.1, usual))  # no synchronisation: any moment will do
        except subprocess.TimeoutExpired:
            run.send_signal(signal.SIGKILL)
            cut_short += 1
        assert run.wait(PATIENCE_S) in (0, -signal.SIGKILL)
        change(inbox, kill + 1, chance)
    assert cut_short > KILLS // 4, "the runs were hardly disturbed"
    finish(inbox, out, "--resume")
    finish(inbox, tmp_path / "clean")
    assert grades(out) == grades(tmp_path / "clean")
    assert pages(out) == pages(tmp_path / "clean")
    assert not list(out.rglob("*.tmp")), "nothing half-written is left"


def duration(work: Callable[[], object]) -> float:
    begun = time.monotonic()
    work()
    return time.monotonic() - begun


# On a disk of its own, which is full but for some pages when the run begins; then there is room again. What stands on
# the disk in the end is copied out, as the disk is gone with its process.
ON_A_FULL_DISK = """
import ctypes, os, shutil, subprocess, sys
from pathlib import Path
from course_kit.grading.sandbox import namespaces
disk, kept, free, *command = sys.argv[1:]
libc = ctypes.CDLL(None, use_errno=True)
try:
    namespaces.enter(namespaces.CLONE_NEWNS)
except OSError:
    sys.exit("REFUSED")
flags = ctypes.c_ulong(0x4000 | 0x40000)
assert libc.mount(None, b"/", None, flags, None) == 0
assert libc.mount(b"tmpfs", disk.encode(), b"tmpfs", ctypes.c_ulong(0), b"size=8m") == 0
out = Path(disk, "out")
out.mkdir()
filler = Path(disk, "filler")
with filler.open("wb", buffering=0) as file:
    try:
        while True:
            file.write(bytes(4096))
    except OSError:
        pass
    file.truncate(file.tell() - 1024 * int(free))
full = subprocess.run(command, capture_output=True, text=True, timeout=100)
print(full.returncode, full.stderr, sep="\\n", flush=True)
results = len(list(out.glob("students/*/*.json")))
print("RESULTS", results)
filler.unlink()
again = subprocess.run([*command, "--resume"], capture_output=True, text=True, timeout=100)
print(again.stderr)
shutil.copytree(out, kept)
sys.exit(again.returncode)
"""


def needed_kb(out: Path, folder: str) -> int:
    """What a folder takes of a disk."""
    return sum(4 * math.ceil(path.stat().st_size / 4096) for path in (out / folder).rglob("*") if path.is_file())


@pytest.mark.parametrize("place", ["results", "exports"])
def test_a_full_disk_is_said_and_costs_nothing(place: str, inbox: Path, tmp_path: Path) -> None:
    clean = tmp_path / "clean"
    finish(inbox, clean)
    results, written_last = needed_kb(clean, "students"), needed_kb(clean, "exports")
    free = {"beginning": 0, "results": results // 2, "exports": results + written_last // 2}[place]
    fewest, most = {"beginning": (0, 0), "results": (1, SIZE - 1), "exports": (SIZE, SIZE)}[place]
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    program = [sys.executable, "-c", ON_A_FULL_DISK, str(disk), str(kept), str(free)]
    done = subprocess.run(
        [*program, *command(inbox, disk / "out")],
        env=environment.child_environment(),
        capture_output=True,
        text=True,
        timeout=2 * PATIENCE_S,
        check=False,
    )
    if done.stderr.strip() == "REFUSED":
        assert not isolation_status().files, "whoever may not mount is not isolated in files either"
        return
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.startswith("2\n"), done.stdout
    assert "No space left on device" in done.stdout
    assert "then run:\n" in done.stdout
    assert f"--out {disk / 'out'} --workers 2 --resume" in done.stdout
    assert "Traceback" not in done.stdout
    written = int(done.stdout.partition("RESULTS ")[2].partition("\n")[0])
    assert fewest <= written <= most, done.stdout
    if written:
        assert f"{SIZE} submissions, {written} of them already have a result from an earlier run." in done.stdout
    assert grades(kept) == grades(clean)
    assert not list(kept.rglob("*.tmp"))

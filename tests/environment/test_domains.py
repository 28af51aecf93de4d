from __future__ import annotations

import os
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import pytest

from course_kit.environment import domains

if TYPE_CHECKING:
    from pathlib import Path

HOLD = """
import sys
from course_kit.environment import domains
lease = domains.share(sys.argv[1]) if len(sys.argv) > 1 else domains.exclusive()
print(lease.domain_id, flush=True)
sys.stdin.read()
"""


@pytest.fixture(autouse=True)
def own_machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Leases of these tests live in a folder of their own, as on a machine without other courses."""
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)


class Holder:
    """A child process that holds a lease until it is told to end or is killed."""

    def __init__(self, *owner: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", HOLD, *owner], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        assert self.process.stdout is not None
        self.domain_id = int(self.process.stdout.readline())

    def kill(self) -> None:
        self.process.kill()
        self.process.communicate()


def test_an_owner_gets_the_same_domain_every_time() -> None:
    first = domains.share("me")
    domain_id = first.domain_id
    first.release()
    assert domains.share("me").domain_id == domain_id


def test_processes_of_one_owner_share_and_others_are_kept_apart() -> None:
    mine = domains.share("me")
    sibling, stranger = Holder("me"), Holder("somebody else")
    assert sibling.domain_id == mine.domain_id
    assert stranger.domain_id != mine.domain_id
    sibling.kill()
    stranger.kill()


def test_an_owner_whose_number_is_taken_moves_and_its_processes_follow() -> None:
    usual = domains.share("me")
    number = usual.domain_id
    usual.release()
    with_number = next(name for name in map(str, range(10_000)) if domains._candidates(name)[0] == number)
    squatter = Holder(with_number)
    assert squatter.domain_id == number
    moved = domains.share("me")
    assert moved.domain_id != number
    squatter.kill()
    # The usual number is free again, but a process of ours lives on the other one: that decides.
    assert domains.share("me").domain_id == moved.domain_id


def test_an_exclusive_domain_is_never_handed_out_twice_and_comes_back_after_a_kill() -> None:
    first = Holder()
    second = domains.exclusive()
    assert first.domain_id != second.domain_id
    first.kill()
    assert domains.exclusive().domain_id == first.domain_id


def test_an_exclusive_domain_is_not_shared_with_an_owner_of_its_number() -> None:
    lease = domains.exclusive()
    owner = next(name for name in map(str, range(10_000)) if domains._candidates(name)[0] == lease.domain_id)
    assert domains.share(owner).domain_id != lease.domain_id


def test_when_all_are_taken_the_message_says_what_to_do() -> None:
    leases = [domains.exclusive() for _ in range(domains.FIRST, domains.LAST + 1)]
    assert sorted(lease.domain_id for lease in leases) == list(range(1, 102))
    with pytest.raises(domains.NoDomainError, match="Close some of them, or set ROS_DOMAIN_ID"):
        domains.exclusive()


def test_racing_processes_get_different_domains() -> None:
    program = "from course_kit.environment import domains; print(domains.exclusive().domain_id, flush=True); input()"
    racers = [
        subprocess.Popen([sys.executable, "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(6)
    ]
    numbers = [int(racer.stdout.readline()) for racer in racers if racer.stdout]
    for racer in racers:
        racer.communicate("\n")
    assert len(set(numbers)) == len(racers)


def test_another_users_lock_file_that_may_not_be_written_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    usual = domains.share("me")
    number = usual.domain_id
    usual.release()
    real_open = os.open

    def refusing(path: object, flags: int, mode: int = 0o777) -> int:
        if str(path).endswith(f"/{number}"):
            raise PermissionError(13, "not yours", str(path))
        return real_open(path, flags, mode)

    monkeypatch.setattr(os, "open", refusing)
    assert domains.share("me").domain_id != number


def test_one_who_queues_gets_the_next_domain_that_comes_back() -> None:
    held = [domains.exclusive() for _ in range(domains.FIRST, domains.LAST + 1)]
    queued: list[domains.Lease] = []
    waiting = threading.Thread(target=lambda: queued.append(domains.exclusive(patience_s=60.0)))
    waiting.start()
    waiting.join(0.2)
    assert not queued
    back = held.pop()
    back.release()
    waiting.join(60)
    assert [lease.domain_id for lease in queued] == [back.domain_id]
    for lease in (*held, *queued):
        lease.release()


def test_more_who_want_a_domain_than_there_are_take_turns_and_never_share() -> None:
    """Twice as many as there are, as workers of a class without network namespaces would be."""
    in_use: set[int] = set()
    collisions: list[int] = []
    guard = threading.Lock()

    def one() -> None:
        with domains.exclusive_domain(patience_s=100.0) as domain_id:
            with guard:
                collisions.extend({domain_id} & in_use)
                in_use.add(domain_id)
            threading.Event().wait(0.05)  # some work
            with guard:
                in_use.discard(domain_id)

    count = 2 * (domains.LAST - domains.FIRST + 1)
    with ThreadPoolExecutor(count) as workers:
        for done in [workers.submit(one) for _ in range(count)]:
            done.result()
    assert not collisions

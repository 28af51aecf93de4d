from __future__ import annotations

import os
import secrets
import socket
import subprocess
import sys
from contextlib import suppress
from typing import TYPE_CHECKING

import pytest

from course_kit.environment import domains
from course_kit.environment.domains import Leases

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

    Hold = Callable[..., "Holder"]

HOLD = """
import os, sys
from course_kit.environment.domains import Leases
scope, *owner = sys.argv[1:]
lease = Leases(scope, frozenset).share(*owner) if owner else Leases(scope, frozenset).lease_exclusive()
print(lease.domain_id, flush=True)
"""
AND_FORK = """
if os.fork():
    os._exit(0)
os.read(0, 100)
more = "import os; os.write(1, b'started\\\\n'); os.read(0, 100); os.write(1, b'yes\\\\n')"
os.execv(sys.executable, [sys.executable, "-S", "-c", more])
"""
IN_A_NETWORK_THAT_IS_OFF = """
from course_kit.grading.sandbox import namespaces
namespaces.enter(namespaces.CLONE_NEWNET)
"""


@pytest.fixture
def scope() -> str:
    """Leases of these tests are apart from all others, as on a machine without other courses."""
    return f"test {secrets.token_hex(8)}"


class Remembered(Leases):
    """Leases that can be given back all together."""

    def __init__(self, scope: str, occupied: Callable[[], Container[int]] = frozenset) -> None:
        super().__init__(scope, occupied)
        self._given: list[domains.Lease] = []

    def share(self, owner: str) -> domains.Lease:
        self._given.append(super().share(owner))
        return self._given[-1]

    def lease_exclusive(self) -> domains.Lease:
        self._given.append(super().lease_exclusive())
        return self._given[-1]

    def rest(self) -> set[int]:
        """The domains that could still be had."""
        before = len(self._given)
        for _ in range(domains.FIRST, domains.LAST + 1):
            with suppress(domains.NoDomainError):
                self.lease_exclusive()
        rest = {lease.domain_id for lease in self._given[before:]}
        self.release(before)
        return rest

    def release(self, first: int = 0) -> None:
        for lease in self._given[first:]:
            lease.release()
        del self._given[first:]


@pytest.fixture
def leases(scope: str) -> Iterator[Remembered]:
    given = Remembered(scope)
    yield given
    given.release()


class Holder:
    """A child process that holds a lease until it is killed.

    Args:
        scope: of its lease.
        owner: the owner it shares with; none for an exclusive lease.
        before: what it does first.
        after: what it does with the lease; to wait for its end when empty.
        environ: variables it has beside ours.
    """

    def __init__(self, scope: str, *owner: str, before: str = "", after: str = "", **environ: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", before + HOLD + (after or "sys.stdin.read()"), scope, *owner],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **environ},
        )
        assert self.process.stdout is not None
        told = self.process.stdout.readline()
        self.domain_id = int(told) if told else 0
        self.problem = "" if told else self.process.communicate()[1]

    def tell(self, line: str) -> str:
        """Write a line to it, and read one."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(f"{line}\n")
        self.process.stdin.flush()
        return self.process.stdout.readline()

    def kill(self) -> None:
        if not self.problem:
            self.process.kill()
            self.process.communicate()


@pytest.fixture
def hold(scope: str) -> Iterator[Hold]:
    """Starts holders, which end with the test."""
    started: list[Holder] = []

    def start(*owner: str, **options: str) -> Holder:
        started.append(Holder(scope, *owner, **options))
        return started[-1]

    yield start
    for holder in started:
        holder.kill()


def owner_of(number: int) -> str:
    """An owner whose usual number is this one."""
    return next(name for name in map(str, range(10_000)) if domains._candidates(name)[0] == number)


def test_processes_of_one_owner_share_and_others_are_kept_apart(leases: Leases, hold: Hold) -> None:
    mine = leases.share("me")
    sibling, stranger = hold("me"), hold("somebody else")
    assert sibling.domain_id == mine.domain_id
    assert stranger.domain_id != mine.domain_id


def test_an_owner_whose_number_is_taken_moves_and_its_processes_follow(leases: Leases, hold: Hold) -> None:
    usual = leases.share("me")
    number = usual.domain_id
    usual.release()
    squatter = hold(owner_of(number))
    assert squatter.domain_id == number
    moved = leases.share("me")
    assert moved.domain_id != number
    squatter.kill()
    # The usual number is free again, but a process of ours lives on the other one: that decides.
    assert leases.share("me").domain_id == moved.domain_id


def test_a_shared_domain_is_leased_until_its_last_process_has_gone(leases: Remembered, hold: Hold) -> None:
    first, *others = (hold("me") for _ in range(4))
    number = first.domain_id
    assert {other.domain_id for other in others} == {number}
    first.kill()
    while others:
        assert leases.rest() == set(range(1, 102)) - {number}
        others.pop().kill()
    assert leases.rest() == set(range(1, 102))


def test_an_exclusive_domain_is_never_handed_out_twice_and_comes_back_after_a_kill(leases: Leases, hold: Hold) -> None:
    first = hold()
    second = leases.lease_exclusive()
    assert first.domain_id != second.domain_id
    first.kill()
    assert leases.lease_exclusive().domain_id == first.domain_id


def test_when_all_are_taken_the_message_says_what_to_do(leases: Leases) -> None:
    taken = [leases.lease_exclusive() for _ in range(domains.FIRST, domains.LAST + 1)]
    assert sorted(lease.domain_id for lease in taken) == list(range(1, 102))
    with pytest.raises(domains.NoDomainError, match="Close some of them, or set ROS_DOMAIN_ID"):
        leases.lease_exclusive()
    with pytest.raises(domains.NoDomainError, match="Close some of them, or set ROS_DOMAIN_ID"):
        leases.share("me")


def test_without_a_loopback_interface_the_message_says_what_to_do(hold: Hold) -> None:
    with pytest.raises(domains.NoLoopbackError, match="ip link set lo up"):
        domains._bind("192.0.2.1", 7402)  # an address for documentation, which no machine has
    for owner in ((), ("me",)):
        problem = hold(*owner, before=IN_A_NETWORK_THAT_IS_OFF).problem.splitlines()[-1]
        assert "NoLoopbackError" in problem or "Error: [Errno" in problem  # namespaces are refused


def test_a_fork_keeps_the_domain_and_a_program_it_starts_does_not(leases: Remembered, hold: Hold) -> None:
    forked = hold(after=AND_FORK)
    assert forked.process.wait(60) == 0
    assert forked.domain_id not in leases.rest()
    assert forked.tell("another program") == "started\n"
    assert forked.domain_id in leases.rest()
    assert forked.tell("still there?") == "yes\n"


def test_a_domain_with_nodes_of_somebody_without_a_lease_is_passed_over(scope: str, domain: int) -> None:
    leases = Remembered(scope, domains.domains_in_use)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as robot:
        robot.bind(("127.0.0.1", domains.discovery_ports(domain)[50]))
        beside_it = leases.rest()
        assert beside_it
        assert domain not in beside_it
    assert domain in leases.rest()


def test_a_port_that_the_kernel_leaves_out_of_one_look_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    looks = iter([[(7400, 2)], [], [(7650, 4)], [], [], []])  # of IPv4 and IPv6 in turns
    monkeypatch.setattr(domains, "_rows", lambda _table: next(looks))
    assert domains.bound_ports() == [(7400, 2), (7650, 4)]

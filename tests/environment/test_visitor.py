"""The profile of a process that comes, asks and goes."""

from __future__ import annotations

import os
import re
import socket
from contextlib import ExitStack
from pathlib import Path

import pytest

from course_kit import environment
from course_kit.environment import domains, visitor

PROFILE = environment.middleware.PROFILE_VARIABLE


@pytest.fixture(autouse=True)
def kits_profile(monkeypatch: pytest.MonkeyPatch, domain: int) -> None:
    assert domain
    monkeypatch.setenv(PROFILE, str(environment.LOOPBACK_PROFILE))


def peers(text: str) -> list[int]:
    return [int(port) for port in re.findall(r"<port>(\d+)</port>", text)]


def test_its_profile_is_the_courses_but_for_whom_it_announces_itself_to() -> None:
    with visitor.visit_graph() as visits:
        text = Path(os.environ[PROFILE]).read_text(encoding="utf-8")
    assert visits
    without = re.sub(r"<initialPeersList>.*</initialPeersList>", "", text)
    plain = environment.LOOPBACK_PROFILE.read_text(encoding="utf-8")
    assert without == re.sub(r"<initialPeersList>.*</initialPeersList>", "", plain)


def test_it_announces_itself_to_those_who_are_there_last_and_to_those_who_may_begin_now(domain: int) -> None:
    """Fewer announcements are over sooner: no answer comes before it listens."""
    most = re.search(r"maxInitialPeersRange>(\d+)<", environment.LOOPBACK_PROFILE.read_text(encoding="utf-8"))
    assert most is not None
    beyond = 10 + 2 * int(most[1])  # no participant of this graph has that place
    there = [domains.port_at(domain, place) for place in (10, 14, beyond - 2, beyond)]
    next_ones = [domains.port_at(domain, place) for place in (12, 16, 18, 20, 22, 24, 26, 28)]
    with ExitStack() as stack:
        for number in (*there, domains.port_at(domain, 11)):
            stack.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)).bind(("127.0.0.1", number))
        with visitor.visit_graph():
            text = Path(os.environ[PROFILE]).read_text(encoding="utf-8")
    assert peers(text) == [*next_ones, there[2], there[1], there[0]]


def test_what_is_started_afterwards_has_the_usual_profile() -> None:
    with visitor.visit_graph():
        assert os.environ[PROFILE] != str(environment.LOOPBACK_PROFILE)
    assert os.environ[PROFILE] == str(environment.LOOPBACK_PROFILE)
    with pytest.raises(KeyError), visitor.visit_graph():
        raise KeyError
    assert os.environ[PROFILE] == str(environment.LOOPBACK_PROFILE)

"""Lines are handed out when they are used, and not before."""

from __future__ import annotations

import socket

from course_kit.process.first_uses import first_uses


def test_each_line_comes_when_it_is_used_or_closed() -> None:
    pairs = [socket.socketpair() for _ in range(3)]
    lines = [ours for ours, _ in pairs]
    pairs[1][1].send(b"x")
    uses = first_uses(lines)
    assert next(uses) == (lines[1], (lines[0], lines[2]))
    pairs[1][1].send(b"more")  # on a line that was used already
    pairs[2][1].close()
    assert next(uses) == (lines[2], (lines[0],))
    pairs[0][1].send(b"x")
    assert list(uses) == [(lines[0], ())]
    assert lines[1].recv(10) == b"xmore", "nothing is taken off a line"
    for pair in pairs:
        for end in pair:
            end.close()


def test_without_lines_there_are_none() -> None:
    assert list(first_uses([])) == []

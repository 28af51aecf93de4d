"""The recorded samples of the real command: reading them, and what varies from run to run taken out."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass

from .commands import GOLDEN

_VARYING = (
    (r"ID: [0-9a-f]{32}", "ID: <id>"),
    (r"\d{10}\.\d{9}", "<time>"),
    (r"\bpid \[?\d+", "pid <pid>"),
    (r"(below) \S+", r"\1 <logs>"),
    (r"hello \d+", "hello <count>"),
    (r"cmd '.*'", "cmd <command>"),
    # As often as it is waited; not at all when the subscription is known before the publisher is made.
    (r"(Waiting for at least 1 matching subscription\(s\)\.\.\.\n)+", ""),
    (r"(- -?\d+\n)+", "- <numbers>\n"),
    (r"(Feedback:\n    sequence:\n- <numbers>\n\n)+", "<feedback>\n"),
)


@dataclass(frozen=True)
class Recording:
    name: str
    words: tuple[str, ...]
    exit_code: int
    interrupted: bool
    seconds: float
    stdout: str
    stderr: str


def read(name: str) -> Recording:
    text = (GOLDEN / f"{name}.txt").read_text()
    head, rest = text.split("===== stdout =====\n")
    stdout, rest = rest.split("===== stderr =====\n")
    facts = dict(re.findall(r"^# ([\w ]+): (.*)$", head, re.MULTILINE))
    return Recording(
        name,
        tuple(shlex.split(head.splitlines()[0].removeprefix("$ ros2 "))),
        int(facts["exit code"]),
        facts["ended"] != "exited",
        float(facts["seconds"]),
        stdout,
        rest.removesuffix("===== end =====\n"),
    )


def all_names() -> list[str]:
    return sorted(path.stem for path in GOLDEN.glob("*.txt"))


def normal(text: str) -> str:
    """Text without ids, times and counts."""
    for pattern, replacement in _VARYING:
        text = re.sub(pattern, replacement, text)
    # Feedback may come before the answers to the goal and to the request to cancel it (README of the recordings).
    text = text.replace(
        "<feedback>\nGoal accepted with ID: <id>\n\n<feedback>\n", "Goal accepted with ID: <id>\n\n<feedback>\n"
    )
    return re.sub(r"(Canceling goal\.\.\.\n)(<feedback>\n)?(Goal canceled\.\n)(<feedback>\n)?", r"\1\3", text)

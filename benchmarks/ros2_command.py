"""The course kit's `ros2` against the real one: `python benchmarks/ros2_command.py [--settle RUNS]`.

The real command's seconds stand in its recordings (tests/ros2cli/golden); ours are measured here, each a process of its
own, against the node of the recordings. A first listing without the daemon and an empty graph are measured as well.
With --settle, listings are made again and again while a node is up, and the empty ones counted.
"""

from __future__ import annotations

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from course_kit import environment

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

GOLDEN = Path(__file__).resolve().parent.parent / "tests" / "ros2cli" / "golden"
ROUNDS = 11
# The script an installer makes of the entry point, without the module search of `python -m`.
SCRIPT = "from course_kit.ros2cli.cli import leave, run_program; leave(run_program())"
CALL = ("service", "call", "/set_power", "std_srvs/srv/SetBool", "{data: true}")
# What is run -> the recordings of the same, and the ratio that is aimed at.
CASES: dict[tuple[str, ...], tuple[str, float | None]] = {
    ("service", "list"): ("service_list", 0.5),
    CALL: ("service_call", 0.5),
    ("service", "list", "--no-daemon"): ("service_list", None),
    ("node", "info", "/robot"): ("node_info", None),
    ("action", "list", "-t"): ("action_list_t", None),
    ("topic", "list"): ("topic_list", None),
    ("topic", "echo", "/chatter", "--once"): ("topic_echo_once", None),
    ("param", "get", "/robot", "robot_name"): ("param_get", None),
    ("interface", "show", "std_srvs/srv/SetBool"): ("interface_show_srv", None),
}


def recorded(case: str) -> list[float]:
    """Seconds of the real command: each recording of the case that ran to a good end."""
    texts = [path.read_text() for path in sorted(GOLDEN.glob(f"*{case}*.txt"))]
    good = [text for text in texts if "exit code: 0" in text and "ended: exited" in text]
    exact = [text for path, text in zip(sorted(GOLDEN.glob(f"*{case}*.txt")), texts, strict=True) if path.stem == case]
    return [float(match[1]) for text in exact or good if (match := re.search(r"seconds: ([\d.]+)", text))]


def seconds_of(words: tuple[str, ...], environ: dict[str, str]) -> float:
    started = time.perf_counter()
    subprocess.run([sys.executable, "-c", SCRIPT, *words], env=environ, check=True, capture_output=True)
    return time.perf_counter() - started


def print_timings(environ: dict[str, str]) -> None:
    print(f"  {'ros2 ...':<48} {'real':>8} {'ours':>8} {'from .. to':>17} {'ratio':>6}  aim")
    taken: dict[tuple[str, ...], list[float]] = {words: [] for words in CASES}
    seconds_of(("service", "list"), environ)  # starts the daemon
    for _ in range(ROUNDS):
        for words in CASES:
            taken[words].append(seconds_of(words, environ))
    for words, (case, aim) in CASES.items():
        real = statistics.median(recorded(case))
        ours = statistics.median(taken[words])
        verdict = "" if aim is None else f"<= {aim:g} {'met' if ours / real <= aim else 'MISSED'}"
        spread = f"{min(taken[words]) * 1e3:.0f}..{max(taken[words]) * 1e3:.0f} ms"
        print(f"  {' '.join(words):<48} {real:>6.2f} s {ours:>6.2f} s {spread:>17} {ours / real:>5.2f}x  {verdict}")
    interpreter = statistics.median(alone(environ) for _ in range(ROUNDS))
    print(f"\n  Of each of ours, {interpreter * 1e3:.0f} ms are the interpreter with the ROS wheels, doing nothing.")
    load, cores = os.getloadavg()[0], os.cpu_count() or 1
    busy = " The recordings were made on an idle machine: measure again when this one is." if load > cores else ""
    print(f"  Load average {load:.1f} on {cores} cores.{busy}\n")


def alone(environ: dict[str, str]) -> float:
    started = time.perf_counter()
    subprocess.run([sys.executable, "-c", "pass"], env=environ, check=True)
    return time.perf_counter() - started


def print_empty(environ: dict[str, str]) -> None:
    taken = [seconds_of(("service", "list"), environ) for _ in range(ROUNDS)]
    real = recorded("empty_graph_service_list")[0]
    print(f"  service list on an empty graph: real {real:.2f} s, ours {statistics.median(taken):.2f} s\n")


def count_listings(environ: dict[str, str], runs: int) -> None:
    """Half of the runs ask the daemon, of which every tenth has to start it; the others look themselves."""
    wanted, empty, short = 8, 0, 0
    begun = time.perf_counter()
    for run in range(runs):
        if run % 20 == 0:
            seconds_of(("daemon", "stop"), environ)
        words = ("service", "list", *(("--no-daemon",) if run % 2 else ()))
        done = subprocess.run(
            [sys.executable, "-c", SCRIPT, *words], env=environ, check=True, capture_output=True, text=True
        )
        found = len(done.stdout.splitlines())
        empty += found == 0
        short += 0 < found < wanted
    each = (time.perf_counter() - begun) / runs
    print(f"  {runs} listings while a node is up: {empty} empty, {short} incomplete; {each:.2f} s each\n")


def clean_environ(domain: int) -> dict[str, str]:
    """As in a fresh terminal: the ROS wheels have not been set up yet."""
    return environment.child_environment(
        ROS_DOMAIN_ID=str(domain), _ROS_WHEELS_BOOTSTRAP_COMPLETE=None, LD_LIBRARY_PATH=None
    )


def robot(environ: dict[str, str]) -> AbstractContextManager[None]:
    from contextlib import contextmanager

    @contextmanager
    def running() -> Iterator[None]:
        with (
            tempfile.TemporaryFile() as said,
            subprocess.Popen(
                [sys.executable, str(GOLDEN / "demo_node.py")], env=environ, stdout=said, stderr=said
            ) as node,
        ):
            while not subprocess.run(
                [sys.executable, "-c", SCRIPT, "node", "list"], env=environ, check=True, capture_output=True
            ).stdout:
                pass
            yield
            node.kill()

    return running()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--settle", type=int, metavar="RUNS", default=0, help="count listings instead")
    options = parser.parse_args()
    with environment.exclusive_domain() as domain:
        environ = clean_environ(domain)
        if options.settle:
            with robot(environ):
                count_listings(environ, options.settle)
        else:
            print("The ros2 command; seconds of the real one as recorded, medians\n")
            print_empty(environ)
            with robot(environ):
                print_timings(environ)
        seconds_of(("daemon", "stop"), environ)


if __name__ == "__main__":
    main()

"""Grades programs as another user, or where namespaces are refused: a process of its own, which it changes for good.

Usage: python -c "... attack_modes.main()" MODE EXERCISE < programs.json > outcomes.json

Everything is imported before the user changes: the interpreter may lie where that user may not read.
"""

from __future__ import annotations

import atexit
import json
import os
import shlex
import socket
import stat
import subprocess
import sys
import tempfile
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from course_kit.grading.model.exercise import Exercise, load_exercise
from course_kit.grading.model.submission import Submission
from course_kit.grading.sandbox import file_view, isolation, launcher, namespaces, seccomp
from course_kit.grading.sandbox.supervisor import Supervisor, enter_own_network
from course_kit.grading.workers import exercise_job, worker_process
from course_kit.process import libc
from course_kit.process.channel import Channel
from course_kit.process.libc import adopt_orphans
from tests.grading.conftest import EXERCISE, ROOT

if TYPE_CHECKING:
    from course_kit.grading.model.job import Job

USER, USER_ALONE, AS_ROOT, ROOT_ALONE = "user", "user without namespaces", "root", "root without namespaces"
BARE = "user without namespaces and Landlock"
COMMAND = "user, by --exec"
ROOT_ITSELF = "root whose Python nobody else can read"
ROOT_ITSELF_ALONE = f"{ROOT_ITSELF}, without namespaces"
OF_USER, OF_ROOT = (USER, COMMAND, USER_ALONE, BARE), (AS_ROOT, ROOT_ALONE, ROOT_ITSELF, ROOT_ITSELF_ALONE)
_LANDLOCK = {"landlock_create_ruleset": (444, 444)}
NOBODY = 65534


_START = (
    "import sys; sys.path.insert(0, sys.argv.pop(1)); "
    "from tests.grading.sandbox import attack_modes; attack_modes.main()"
)


def outcomes(mode: str, programs: dict[str, str]) -> dict[str, Any]:
    """Grade programs in a process of that mode.

    Returns:
        the outcome of each by its name, and what was found to isolate them as "isolation".
    """
    from tests.grading.sandbox.attacks import SEED  # not above: the process that starts submissions must not know it

    command = [sys.executable, "-c", _START, str(ROOT), mode, EXERCISE]
    asked = json.dumps({**programs, "seed": SEED})
    done = subprocess.run(command, input=asked, capture_output=True, text=True, cwd="/", timeout=350, check=False)
    assert done.returncode == 0, done.stderr
    first, *rows = (json.loads(line) for line in done.stdout.splitlines())
    by_name = {row["name"]: row for row in rows}
    assert set(by_name) == set(programs)
    return {"isolation": isolation.Isolation(**first["isolation"]), **by_name}


def main() -> None:
    """Read programs, a JSON object by name, and print the outcome of each, and what isolated them."""
    mode, name = sys.argv[1:]
    worker_process.warm_up()
    os.environ.update(ROS_LOG_DIR=tempfile.gettempdir(), HOME="/nonexistent")
    if mode in OF_USER and os.getuid() == 0:
        open_the_way(sys.base_prefix)
        become_nobody()
    if mode in (ROOT_ITSELF, ROOT_ITSELF_ALONE):
        hide_the_kit(file_view.ROBOT)
    if mode not in (USER, COMMAND, AS_ROOT, ROOT_ITSELF):
        refuse_namespaces(_LANDLOCK if mode == BARE else {})
    namespaces.forbid_tracing()
    adopt_orphans()
    found = isolation.begin_trial()()
    handle = launcher.Launcher()
    if os.fork() == 0:
        handle.close()
        launcher.serve(handle.other_end, ())
        os._exit(0)
    handle.other_end.close()
    exercise = load_exercise(name)  # now: the process that starts submissions must not know it
    programs = json.load(sys.stdin)
    seed = programs.pop("seed")
    print(json.dumps({"isolation": asdict(found)}), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        _grade_each(programs, (exercise, seed), mode, found, handle)
        os.chdir("/")


def _grade_each(
    programs: dict[str, str],
    asked: tuple[Exercise, int],
    mode: str,
    found: isolation.Isolation,
    handle: launcher.Launcher,
) -> None:
    for program, source in programs.items():
        user = isolation.guest_user(os.getpid()) if found.user else 0
        job = (of_command if mode == COMMAND else of_program)(*asked, source)
        job = replace(job, isolation=found, user=user)
        sys.stdout.flush()
        if os.fork() == 0:
            adopt_orphans()
            network = enter_own_network(user) if found.network else ()
            parent, _open = map(Channel, socket.socketpair())
            outcome = Supervisor(job, handle, file_view.find_view(), network, parent).run(worker_process.run_checks)
            print(json.dumps({"name": program, **outcome}), flush=True)
            os._exit(0)
        os.wait()


def of_program(exercise: Exercise, seed: int, source: str) -> Job:
    """The job of grading a program."""
    text = Submission("answer.py", "answer.py", source)
    return replace(exercise_job.make_job_of_node(exercise, seed), mode="run", text=text)


def of_command(exercise: Exercise, seed: int, source: str) -> Job:
    """The job of grading the same program as a command, which sees the folder that it is started from."""
    Path("answer.py").write_text(source)
    return exercise_job.make_job_of_node(exercise, seed, shlex.join([sys.executable, "answer.py"]))


def open_the_way(path: str) -> None:
    """Have every user find a folder that lies in a private one, such as a Python in root's home; as root."""
    private = [place for place in reversed(Path(path).parents) if not place.stat().st_mode & stat.S_IXOTH]
    if private:
        libc.call_libc("unshare", namespaces.CLONE_NEWNS)
        file_view.detach_mounts()
        opened = os.open(path, os.O_PATH)
        file_view.mount_memory(str(private[0]), 1)
        Path(path).mkdir(parents=True)
        file_view.bind(f"/proc/self/fd/{opened}", path)
        os.close(opened)


def hide_the_kit(path: str) -> None:
    """Have nobody but root read a file that submissions need, as with a Python in root's home; as root."""
    libc.call_libc("unshare", namespaces.CLONE_NEWNS)
    file_view.detach_mounts()
    opened, private = tempfile.mkstemp()  # its mode is 0600
    atexit.register(os.unlink, private)
    os.write(opened, Path(path).read_bytes())
    os.close(opened)
    file_view.bind(private, path)


def become_nobody() -> None:
    """Give up root."""
    namespaces.become(NOBODY)
    namespaces.allow_tracing()  # as after an exec: /proc/self belongs to the user


def refuse_namespaces(more: dict[str, tuple[int, int]]) -> None:
    """Have the kernel refuse what the default profile of Docker refuses, namespaces and mounts, and `more`."""
    ours = seccomp._REFUSED, seccomp._by_arguments
    seccomp._REFUSED = {**more, **{name: seccomp._REFUSED[name] for name in ("unshare", "setns", "mount")}}
    seccomp._by_arguments = lambda *_: iter(())
    seccomp.install()
    seccomp._REFUSED, seccomp._by_arguments = ours

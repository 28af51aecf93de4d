"""`course-kit doctor`: what was found on this machine, a verdict on each, and what to do about it."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import subprocess
import sys
import textwrap
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from course_kit import environment
from course_kit.process.child import NOWHERE, Child
from course_kit.ros2cli import checkup

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

VERDICTS = {"ok": "ok  ", "note": "note", "bad": "BAD "}
_NO_COURSE = "Live nodes, panels, message types and ros2 work; lab, list and grade do not. Install the course again."
_OTHER_RMW = f"Set RMW_IMPLEMENTATION={environment.middleware.SUPPORTED} and start again."
_TRIED = "rclpy 7.1.6 to 7.1.11, with which the course was tried"
_LOSES_RESULTS = "7.1.9"  # https://github.com/ros2/rclpy/issues/1598
DEADLINE_S = 20.0

# A service server in a separate process: what the doctor's client has to discover.
_SERVER = """
import rclpy
from std_srvs.srv import Trigger
rclpy.init()
node = rclpy.create_node("doctor_server")
def answer(request, response):
    response.success = True
    return response
node.create_service(Trigger, "doctor", answer)
rclpy.spin(node)
"""


@dataclass(frozen=True)
class Finding:
    """One line of the doctor's report. `verdict` is "ok", "note" (works, worth knowing) or "bad"."""

    subject: str
    found: str
    verdict: str = "ok"
    advice: str = ""


def run_doctor() -> int:
    """Print the findings as they come; return 0 when nothing is bad, else 1."""
    bad = 0
    for finding in all_findings():
        bad += finding.verdict == "bad"
        print(render_finding(finding), flush=True)
    print()
    problems = f"{bad} problem{'s' * (bad > 1)} must be fixed before the course works."
    print(problems if bad else "The course has everything it needs.")
    return 1 if bad else 0


def render_finding(finding: Finding) -> str:
    """A finding as text of at most 80 columns: verdict, subject, what was found, then the advice."""
    head = f"{VERDICTS[finding.verdict]}  {finding.subject:<17} "
    body = textwrap.wrap(finding.found, 80 - len(head)) or [""]
    lines = [head + body[0], *(" " * len(head) + line for line in body[1:])]
    lines += textwrap.wrap(finding.advice, 80, initial_indent="      -> ", subsequent_indent="         ")
    return "\n".join(lines)


def all_findings() -> Iterator[Finding]:
    """All findings, the quick ones first; whatever goes wrong in one is its own finding."""
    for check in (check_python, check_packages, course_folder, own_files):
        yield guard_check(check)
    graph = guard_check(check_settings)
    yield graph
    for check in (check_jupyter, check_isolation):
        yield guard_check(check)
    ros = guard_check(rclpy_itself)
    yield ros
    if "bad" not in (graph.verdict, ros.verdict):  # the rest would only fail after it
        for check in (rclpy_names, check_middleware, check_interfaces, check_discovery):
            yield guard_check(check)


def guard_check(check: Callable[[], Finding]) -> Finding:
    """The finding of `check`, or a bad one that tells what went wrong."""
    try:
        return check()
    except Exception as problem:  # noqa: BLE001 - a doctor must not fall ill
        subject = check.__name__.removeprefix("check_").replace("_", " ")
        return Finding(
            subject,
            f"{type(problem).__name__}: {problem}",
            "bad",
            "Set the course up again: delete .venv and run ./course lab. Then run ./course doctor again.",
        )


def check_python() -> Finding:
    """The interpreter; the course installs on 3.10 to 3.14 alone."""
    return Finding("Python", f"{platform.python_version()} in {sys.prefix}")


def check_packages() -> Finding:
    """Whether packages have lost files to others."""
    requirement = checkup.find_damaged_package()
    if not requirement:
        return Finding("packages", "no package has overwritten files of another package")
    return Finding(
        "packages",
        f"{checkup.OLD_NAME} has overwritten files of {requirement}, which JupyterLab uses",
        "note" if environment.checkout_folder() is None else "bad",  # only ./course has the say in what is installed
        f"Install {requirement} again: {checkup.reinstall_command(requirement)}",
    )


def course_folder() -> Finding:
    """The lessons and exercises, and whether this user can work on them where they are."""
    root, mine = environment.course_files(), environment.learner_folder() or environment.paths.usual_learner_folder()
    if root is None or not (root / "exercises").is_dir():
        missing = "lessons and exercises" if root is None else "exercises"
        return Finding("course folder", f"the {missing} are missing in {environment.PACKAGE}", "bad", _NO_COURSE)
    if environment.checkout_folder() is None:
        made = "" if mine.is_dir() else f", which {environment.course_command()} lab makes"
        return Finding("course folder", f"installed as a package; you work in {mine}{made}")
    if environment.paths.is_shared(root):
        advice = f"{environment.course_command()} lab opens your own copy: {mine}"
        return Finding("course folder", f"{root}, read-only for you", "note", advice)
    return Finding("course folder", f"{root}; you work in {mine.relative_to(root) if root in mine.parents else mine}")


def own_files() -> Finding:
    """Where logs and the like are kept."""
    folder = environment.state_dir()
    if folder == environment.paths.usual_state_dir():
        return Finding("your files", f"logs and the like are kept in {folder}")
    found = f"logs and the like are kept in {folder}, because your home directory cannot be written"
    advice = (
        "They may disappear after a restart. Set XDG_STATE_HOME to a folder that you can write to and that is kept."
    )
    return Finding("your files", found, "note", advice)


def check_settings() -> Finding:
    """The private graph."""
    try:
        chosen = environment.apply_settings()
    except environment.DomainError as problem:
        return Finding("ROS graph", str(problem), "bad", "The course's nodes cannot run until this is fixed.")
    reach = "this machine only" if chosen.only_this_machine else "other machines can see it"
    found = f"domain {chosen.domain_id}, chosen by {chosen.domain_chosen_by}; {reach}"
    if chosen.only_this_machine:
        return Finding("ROS graph", found)
    advice = "Unset ROS_AUTOMATIC_DISCOVERY_RANGE (or your own Fast DDS profile) to keep the course's nodes private."
    return Finding("ROS graph", found, "note", advice)


def rclpy_itself() -> Finding:
    """Whether rclpy loads, asked in a separate process: a wrong RMW ends the process that imports it."""
    text, failed = _run("import rclpy; print(rclpy.__file__)", ROS_DOMAIN_ID="0")  # nothing joins it
    if failed:
        advice = "Run ./course lab, which installs it; or source a ROS 2 Jazzy first and delete .venv."
        if os.environ.get("RMW_IMPLEMENTATION"):
            advice = f"RMW_IMPLEMENTATION is {os.environ['RMW_IMPLEMENTATION']}: unset RMW_IMPLEMENTATION."
        return Finding("rclpy", f"cannot be imported: {text}", "bad", advice)
    try:
        version, place = importlib.metadata.version("ros-rclpy"), "PyPI wheels"
    except importlib.metadata.PackageNotFoundError:
        version = checkup.version_of_package("rclpy") or "of unknown version"
        place = f"the ROS 2 {os.environ.get('ROS_DISTRO', '')} in {text}"
    advice = _advice_about_rclpy(version)
    return Finding("rclpy", f"{version} from {place}", "note" if advice else "ok", advice)


def _advice_about_rclpy(version: str) -> str:
    """What to know of a version of rclpy; empty when there is nothing."""
    if version == _LOSES_RESULTS:
        return (
            "This version loses the result of a goal if several threads run: a client gets an empty one after a plain "
            "succeed(). Update ROS 2 to rclpy 7.1.10 or later. Until then write goal_handle.succeed(result)."
        )
    if version[:1].isdigit() and not version.startswith("7.1."):
        return (
            "The course is made for ROS 2 Jazzy (rclpy 7.1). What is different with later releases: "
            "notebooks/jazzy_kilted_lyrical.md"
        )
    return ""


def rclpy_names() -> Finding:
    """Whether the names that the course needs of other packages are there, beyond what these document."""
    from course_kit.ros import compat

    off = compat.check_all().sentences()
    if not off:
        return Finding("inside rclpy", "everything that the course uses is present")
    advice = f"There is nothing to do. Nothing is off with {_TRIED}."
    return Finding("inside rclpy", " ".join(off), "note", advice)


def check_middleware() -> Finding:
    """The RMW that is loaded, and whether the live interfaces can work on it."""
    from rclpy.utilities import get_rmw_implementation_identifier

    name = get_rmw_implementation_identifier()
    if name != environment.middleware.SUPPORTED:
        return Finding("RMW", name, "bad", environment.middleware.explain_middleware() or _OTHER_RMW)
    version = checkup.version_of_package(name) if os.environ.get("ROS_DISTRO") else ""  # wheels have their own numbers
    name = f"{name} {version}" if version else name
    if not (replaced := os.environ.get(environment.middleware.REPLACED, "")):
        return Finding("RMW", name)
    advice = f"There is nothing to do. Unset {replaced.partition('=')[0]} to remove this note."
    return Finding("RMW", f"{name}, because {replaced} is not installed here", "note", advice)


def check_jupyter() -> Finding:
    """JupyterLab and the kernel."""
    names = ("jupyterlab", "ipykernel", "ipywidgets")
    return Finding("Jupyter", ", ".join(f"{name} {importlib.metadata.version(name)}" for name in names))


def check_interfaces() -> Finding:
    """The course's own message types, in a Python that never imports the kit."""
    program = (
        "from example_interfaces.srv import AddTwoInts as T; T.__class__.__import_type_support__(); print(T.__module__)"
    )
    text, failed = _run(program)
    if not failed:
        return Finding("message types", "example_interfaces and course_interfaces can be imported in any program")
    return Finding(
        "message types", text, "bad", "Delete .venv and run ./course lab: it builds the small library they need."
    )


def _run(program: str, **environ: str) -> tuple[str, bool]:
    """The last line that a Python program prints in a separate process, and whether it has failed."""
    done = subprocess.run(
        [sys.executable, "-c", program],
        cwd="/",  # a Python looks for modules in its working directory, where a learner's rclpy.py may lie
        env=environment.child_environment(**environ),
        capture_output=True,
        text=True,
        errors="replace",
        timeout=60,
        check=False,
    )
    failed = done.returncode != 0
    return ((done.stderr if failed else done.stdout).strip().splitlines() or ["no message"])[-1], failed


def check_discovery() -> Finding:
    """Time until a client has found and asked a server in another process, on its own domain."""
    try:
        seconds = seconds_to_discover()
    except environment.NoDomainError as problem:
        advice = "Run ./course doctor again when fewer courses and graders are running."
        return Finding("discovery", f"not tried: no ROS domain is free. {problem}", "note", advice)
    if seconds is None:
        advice = "A firewall on the loopback interface, or your own Fast DDS profile, keeps the nodes apart."
        return Finding("discovery", f"no answer from another process within {DEADLINE_S:.0f} s", "bad", advice)
    return Finding("discovery", f"a server in another process answered {seconds:.2f} s after it was started")


def check_isolation() -> Finding:
    """What isolates a submission when it is graded."""
    from course_kit.grading import isolation_status

    found = isolation_status()
    advice = "What it stops and what it does not: course_kit/grading/LIMITS.md"
    return Finding("grader isolation", found.describe(), "note" if found.reason else "ok", advice)


def seconds_to_discover() -> float | None:
    """Seconds until a client was answered by a server in another process, on their own domain; None if never."""
    with environment.exclusive_domain() as domain_id:
        environ = environment.child_environment(ROS_DOMAIN_ID=str(domain_id))
        server = Child([sys.executable, "-c", _SERVER], environ=environ, folder="/", stderr=NOWHERE)
        try:
            return _ask(domain_id)
        finally:
            server.kill()  # a signal that rclpy handles now and then leaves it hanging at its end


def _ask(domain_id: int) -> float | None:
    """Seconds until the server answered, start of its Python included; None when it never did."""
    import rclpy
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from std_srvs.srv import Trigger

    from course_kit.ros.graph import quiet_node
    from course_kit.ros.service import ServiceClient

    started = time.monotonic()
    context = Context()
    rclpy.init(context=context, domain_id=domain_id)
    try:
        node = quiet_node("doctor_client", context)
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(node)
        client = ServiceClient(node, Trigger, "doctor")
        sent = None
        while time.monotonic() - started < DEADLINE_S:
            if sent is None and client.is_ready():
                sent = client.send(Trigger.Request())
            executor.spin_once(timeout_sec=0.02)  # returns as soon as there is anything to do
            if sent is not None and sent.is_answered():
                return time.monotonic() - started
        return None
    finally:
        context.try_shutdown()

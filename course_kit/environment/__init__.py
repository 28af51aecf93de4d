"""The ROS settings of the course, made before rclpy loads.

Everything here is read by ROS from environment variables, so it reaches kernels, terminals in JupyterLab,
child processes and the grader alike. A value the user has set wins wherever it can work.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from dataclasses import dataclass
from pathlib import Path

from course_kit.environment import files, middleware, paths
from course_kit.environment.domains import DomainError, Lease, Leases, NoDomainError, SettingsError, exclusive_domain
from course_kit.environment.files import write_atomically
from course_kit.environment.paths import (
    LEARNER_FOLDER,
    PACKAGE,
    checkout_folder,
    course_command,
    course_files,
    learner_folder,
    run_dir,
    state_dir,
    with_scripts_first,
)

__all__ = [
    "FAST_DISCOVERY_PROFILE",
    "LEARNER_FOLDER",
    "LOOPBACK_PROFILE",
    "PACKAGE",
    "PRIVATE_NETWORK_PROFILE",
    "DomainError",
    "NoDomainError",
    "Settings",
    "SettingsError",
    "apply_settings",
    "checkout_folder",
    "child_environment",
    "choose_graph",
    "course_command",
    "course_files",
    "default_settings",
    "domain_of_user",
    "exclusive_domain",
    "files",
    "heed_interrupts",
    "learner_folder",
    "middleware",
    "paths",
    "run_dir",
    "state_dir",
    "trusted_python",
    "write_atomically",
]

LOOPBACK_PROFILE = middleware.PROFILES / "loopback.xml"
FAST_DISCOVERY_PROFILE = middleware.PROFILES / "fast_discovery.xml"  # where the user has chosen a range
PRIVATE_NETWORK_PROFILE = middleware.PROFILES / "private_network.xml"  # for the grader's own networks
_PROFILES = (str(LOOPBACK_PROFILE), str(FAST_DISCOVERY_PROFILE))
# Tells the kit's own choice from the user's in the environment a child process inherits.
_CHOSEN_BY_KIT = "COURSE_KIT_DOMAIN_ID"
# A name for its own graph beside the course's. In the environment, so that child processes join it, too.
_GRAPH = "COURSE_KIT_GRAPH"
_WITH_OWN_GRAPH = "demos"  # the folder of notebooks that fail on purpose: a node of a lesson would repair them
_HIGHEST_DOMAIN = 232  # the ports of a higher one would lie past 65535


@dataclass(frozen=True)
class Settings:
    """The settings now: the domain, who chose it, and the values of the variables the kit looks after."""

    domain_id: int
    domain_chosen_by: str  # "the course kit" or "ROS_DOMAIN_ID"
    variables: dict[str, str]

    @property
    def only_this_machine(self) -> bool:
        """Whether nodes on other machines can neither see nor reach this graph."""
        if self.variables.get(middleware.PROFILE_VARIABLE) == str(LOOPBACK_PROFILE):
            return True
        return self.variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] in ("LOCALHOST", "OFF")


class _OwnLease:
    """The one lease of this process, kept for as long as the process lives."""

    lease: Lease | None = None
    process_id: int = 0


def default_settings() -> dict[str, str]:
    """The variables of the course with the values used where the user has set none.

    Discovery is left to Fast DDS's profile (SYSTEM_DEFAULT), which keeps it on the loopback interface. Where the
    user has chosen a range, a profile or another middleware, that is respected.
    """
    checks = {"ROS_PYTHON_CHECK_FIELDS": "1"}
    profile = os.environ.get(middleware.PROFILE_VARIABLE, str(LOOPBACK_PROFILE))
    fast_dds = os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
    if not fast_dds or profile not in _PROFILES:
        return {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", **checks}
    chosen = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "") not in ("", "SYSTEM_DEFAULT")
    if chosen or os.environ.get("ROS_LOCALHOST_ONLY", "0") != "0":
        return {
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            middleware.PROFILE_VARIABLE: str(FAST_DISCOVERY_PROFILE),
            "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
            **checks,
        }
    return {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
        middleware.PROFILE_VARIABLE: str(LOOPBACK_PROFILE),
        **checks,
    }


def apply_settings() -> Settings:
    """Put the course's settings into this process's environment; calling it again changes nothing."""
    os.umask(os.umask(0o077) & 0o077)  # what we make we can read, write and enter, whatever a shell has set
    made = _apply_defaults()
    by_user = domain_of_user()
    if by_user is None:
        _hold_domain()
    domain_id = int(os.environ["ROS_DOMAIN_ID"])
    kit = {name: os.environ[name] for name in (*made, "ROS_DOMAIN_ID")}
    return Settings(domain_id, "the course kit" if by_user is None else "ROS_DOMAIN_ID", kit)


def choose_graph(notebook: str) -> None:
    """Join the graph that is meant for a notebook: a demo has its own one. Call it before `apply`."""
    path = Path(notebook)
    if path.parent.name == _WITH_OWN_GRAPH:
        os.environ[_GRAPH] = f"{_WITH_OWN_GRAPH}/{path.stem}"


def child_environment(**changes: str | None) -> dict[str, str]:
    """The environment for a child process: the settings of `apply`, the course's programs first on PATH, `changes`.

    A change of None removes the variable. A changed ROS_DOMAIN_ID counts as the user's choice in the child, and no
    domain is leased for it.
    """
    if changes.get("ROS_DOMAIN_ID"):
        _apply_defaults()
        environ = dict(os.environ)
        environ.pop(_CHOSEN_BY_KIT, None)
    else:
        apply_settings()
        environ = dict(os.environ)
    environ["PATH"] = with_scripts_first(environ.get("PATH"))
    environ.pop("PYTHONOPTIMIZE", None)  # asserts and docstrings are wanted: a check's title is one
    for name, value in changes.items():
        if value is None:
            environ.pop(name, None)
        else:
            environ[name] = value
    return environ


def trusted_python(module: str, function: str, *arguments: str) -> list[str]:
    """The command that calls a function in a fresh Python, to be run with `cwd="/"` if that need not be elsewhere.

    Both `-m` and `-c` put the working directory, where submissions may lie, before Python's own modules. `-P` does not
    exist in Python 3.10, and `-I` would lose the PYTHONPATH of a sourced ROS.
    """
    program = (
        f"import sys; sys.path[:] = [entry for entry in sys.path if entry not in ('', '/')]; "
        f"from {module} import {function}; {function}()"
    )
    return [sys.executable, "-c", program, *arguments]


def heed_interrupts() -> None:
    """Have SIGINT raise KeyboardInterrupt also in what a script has started in the background, which ignores it."""
    if threading.current_thread() is threading.main_thread() and signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _apply_defaults() -> dict[str, str]:
    if problem := middleware.choose_middleware():
        sys.stderr.write(f"course-kit: {problem}\n")
    made = default_settings()
    for name, value in made.items():
        if os.environ.get(name) in _PROFILES:  # inherited from a process in which the user had chosen otherwise
            del os.environ[name]
        os.environ.setdefault(name, value)
    if not os.environ.get("AMENT_PREFIX_PATH"):  # else nothing finds the share folder of a package that pip installed
        os.environ["AMENT_PREFIX_PATH"] = sys.prefix
    if not paths.has_chosen_logs():
        os.environ["ROS_LOG_DIR"] = str(paths.make_log_folder())
    return made


def domain_of_user() -> int | None:
    """The domain that the user has chosen by ROS_DOMAIN_ID; None where the course chooses."""
    value = os.environ.get("ROS_DOMAIN_ID", "")
    if not value or value == os.environ.get(_CHOSEN_BY_KIT):
        return None
    if value not in map(str, range(_HIGHEST_DOMAIN + 1)):  # more is read by ROS as something: 010 as the octal 8
        raise SettingsError(
            f"ROS_DOMAIN_ID is set to '{value}', but it must be a whole number from 0 to {_HIGHEST_DOMAIN}, without "
            "leading zeros. Correct it, or unset it and the course chooses one."
        )
    return int(value)


def _hold_domain() -> None:
    if _OwnLease.lease is None or _OwnLease.process_id != os.getpid():
        for name in ("ROS_DOMAIN_ID", _CHOSEN_BY_KIT):  # what was inherited may be somebody else's by now
            os.environ.pop(name, None)
        # By the bytes of its name: what Python makes of them depends on the locale, and may be no text at all.
        folder = os.fsencode(checkout_folder() or state_dir()).decode("ascii", errors="backslashreplace")
        graph = os.environ.get(_GRAPH, "")
        _OwnLease.lease = Leases().share(f"{os.getuid()}:{folder}{f':{graph}' if graph else ''}")
        _OwnLease.process_id = os.getpid()
    os.environ["ROS_DOMAIN_ID"] = os.environ[_CHOSEN_BY_KIT] = str(_OwnLease.lease.domain_id)

"""What `ros2 doctor` looks at: the packages, the platform, and the graph with its topics and their QoS."""

from __future__ import annotations

import os
import re
import shlex
import sys
from contextlib import suppress
from importlib import import_module, metadata
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.interfaces.known_types import package_prefixes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros2cli.graph import EndpointFacts, Graph

# What ros-rosidl-parser calls `lark`, whose files it overwrites. pyproject.toml keeps uv from installing that; whoever
# installs the kit's wheel with pip gets both.
OLD_NAME = "lark-parser"
_OF_EVERY_NODE = {"/parameter_events", "/rosout"}
_VERSION = re.compile(r"<version[^>]*>\s*([^<\s]+)\s*</version>")
_DURATIONS = ("lifespan", "deadline", "liveliness_lease_duration")


class CheckupResult(NamedTuple):
    """One thing that was looked at."""

    category: str
    errors: list[str]
    warnings: list[str]


def run_checks(graph: Graph) -> list[CheckupResult]:
    """Look at everything."""
    return [_package_check(), _platform_check(), _topic_check(graph), _qos_check(graph)]


def _package_check() -> CheckupResult:
    broken = find_damaged_package()
    text = f"{broken} has lost files, to {OLD_NAME}. Run: {reinstall_command(broken)}"
    return CheckupResult("package", [text] if broken else [], [])


def find_damaged_package() -> str:
    """The requirement of a package that has lost files, "lark==1.3.1"; empty where all are whole."""
    with suppress(metadata.PackageNotFoundError, ImportError):  # an installed ROS 2 brings its own
        wanted = metadata.version("lark")
        return "" if getattr(import_module("lark"), "__version__", "") == wanted else f"lark=={wanted}"
    return ""


def reinstall_command(requirement: str) -> str:
    """The command that installs a package of this Python again, and nothing else; uv makes environments without pip."""
    pip = [sys.executable, "-m", "pip", "install", "--force-reinstall"]
    uv = ["uv", "pip", "install", "--python", sys.executable, "--reinstall"]
    return shlex.join([*(pip if any(metadata.distributions(name="pip")) else uv), "--no-deps", requirement])


def version_of_package(name: str) -> str:
    """The version of a package of a sourced ROS 2, as its package.xml has it; "" if it has none."""
    for prefix in package_prefixes():
        with suppress(OSError):
            text = Path(prefix, "share", name, "package.xml").read_text(encoding="utf-8", errors="replace")
            if found := _VERSION.search(text):
                return found[1]
    return ""


def _platform_check() -> CheckupResult:
    distribution = os.environ.get("ROS_DISTRO", "jazzy")
    wrong = (
        [] if distribution == "jazzy" else [f"The course is made for ROS 2 Jazzy, and ROS_DISTRO is {distribution}."]
    )
    return CheckupResult("platform", [], wrong)


def _topic_check(graph: Graph) -> CheckupResult:
    warnings = []
    for topic, ends in sorted(graph.endpoints.items()):
        if topic in _OF_EVERY_NODE or bool(ends.publishers) == bool(ends.subscriptions):
            continue
        there, missing = ("Publisher", "subscriber") if ends.publishers else ("Subscriber", "publisher")
        warnings.append(f"{there} without {missing} detected on {topic}.")
    return CheckupResult("topic", [], warnings)


def _qos_check(graph: Graph) -> CheckupResult:
    found = CheckupResult("middleware", [], [])
    for topic, publisher, subscription in _pairs(graph):
        severity, reason = _compatibility(publisher, subscription)
        if severity != "OK":
            text = f"QoS compatibility {severity} found on topic '{topic}': {reason}"
            (found.errors if severity == "error" else found.warnings).append(text)
    return found


def _pairs(graph: Graph) -> Iterator[tuple[str, EndpointFacts, EndpointFacts]]:
    for topic, ends in sorted(graph.endpoints.items()):
        for publisher in ends.publishers:
            for subscription in ends.subscriptions:
                yield topic, publisher, subscription


def _compatibility(publisher: EndpointFacts, subscription: EndpointFacts) -> tuple[str, str]:
    """One of "OK", "warning" and "error", and why, as the middleware says."""
    from rclpy.duration import Duration
    from rclpy.qos import QoSCompatibility, QoSProfile, qos_check_compatible

    def profile(facts: EndpointFacts) -> QoSProfile:
        values = dict(facts["qos_profile"])
        times = {name: Duration(nanoseconds=values.pop(name)) for name in _DURATIONS if name in values}
        return QoSProfile(**values, **times)

    severity, reason = qos_check_compatible(profile(publisher), profile(subscription))
    word = {QoSCompatibility.OK: "OK", QoSCompatibility.WARNING: "warning"}.get(severity, "error")
    return word, reason.partition(": ")[2].strip("; ") or reason

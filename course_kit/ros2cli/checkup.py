"""What `ros2 doctor` looks at: the packages, the machine, its network, and the graph with its topics and their QoS."""

from __future__ import annotations

import os
import platform
import re
import socket
import struct
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from course_kit.environment import packages
from course_kit.interfaces.known_types import package_prefixes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from course_kit.ros2cli.graph import EndpointFacts, Graph

_OF_EVERY_NODE = {"/parameter_events", "/rosout"}
_DEVICES = Path("/sys/class/net")
_FLAGS = ("UP", "BROADCAST", "DEBUG", "LOOPBACK", "PTP", "NOTRAILERS", "RUNNING", "NOARP", "PROMISC", "ALLMULTI")
_MORE_FLAGS = ("MASTER", "SLAVE", "MULTICAST", "PORTSEL", "AUTOMEDIA", "DYNAMIC")
_GET_ADDRESS = 0x8915  # SIOCGIFADDR
_INDEX = Path("share", "ament_index", "resource_index", "packages")
_VERSION = re.compile(r"<version[^>]*>\s*([^<\s]+)\s*</version>")
_DURATIONS = ("lifespan", "deadline", "liveliness_lease_duration")

Items = list[tuple[str, str]]


class CheckupResult(NamedTuple):
    """One thing that was looked at."""

    category: str
    errors: list[str]
    warnings: list[str]


class CheckupSection(NamedTuple):
    """What was found."""

    category: str
    title: str
    items: Items


def run_checks(graph: Graph, *, with_packages: bool = True) -> list[CheckupResult]:
    """Look at everything."""
    found = [_platform_check(), _network_check(), _topic_check(graph), _qos_check(graph)]
    return [_package_check(), *found] if with_packages else found


def report_versions(graph: Graph, *, with_packages: bool = True) -> list[CheckupSection]:
    """Say what there is."""
    found = [
        CheckupSection("network", "NETWORK CONFIGURATION", _network_items()),
        CheckupSection("platform", "PLATFORM INFORMATION", _platform_items()),
        CheckupSection("middleware", "QOS COMPATIBILITY LIST", _qos_items(graph)),
        CheckupSection("middleware", "RMW MIDDLEWARE", [("middleware name", _middleware())]),
        CheckupSection("platform", "ROS 2 INFORMATION", _ros_items()),
        CheckupSection("topic", "TOPIC LIST", _topic_items(graph)),
    ]
    return [CheckupSection("package", "PACKAGE VERSIONS", _package_items()), *found] if with_packages else found


def _package_check() -> CheckupResult:
    broken = packages.find_damaged_package()
    said = f"{broken} has lost files, to {packages.OLD_NAME}. Run: {packages.reinstall_command(broken)}"
    return CheckupResult("package", [said] if broken else [], [])


def _package_items() -> Items:
    """The versions in the package.xml of each package of the index; the newest ones nobody knows without a network."""
    found: dict[str, str] = {}
    for prefix in map(Path, package_prefixes()):
        with suppress(OSError):
            for entry in (prefix / _INDEX).iterdir():
                found.setdefault(entry.name, f"local={_version_in(prefix, entry.name) or 'unknown'}")
    return sorted(found.items())


def version_of_package(name: str) -> str:
    """The version of a package of a sourced ROS 2, as its package.xml has it; "" where there is none."""
    return next(filter(None, (_version_in(Path(prefix), name) for prefix in package_prefixes())), "")


def _version_in(prefix: Path, name: str) -> str:
    found = _VERSION.search(_read(prefix / "share" / name / "package.xml"))
    return found[1] if found else ""


def _platform_check() -> CheckupResult:
    distribution = os.environ.get("ROS_DISTRO", "jazzy")
    wrong = (
        [] if distribution == "jazzy" else [f"The course is made for ROS 2 Jazzy, and ROS_DISTRO is {distribution}."]
    )
    return CheckupResult("platform", [], wrong)


def _platform_items() -> Items:
    about = (("system", platform.system()), ("platform info", platform.platform()), ("release", platform.release()))
    return [*about, ("processor", platform.processor() or platform.machine())]


def _ros_items() -> Items:
    from importlib import metadata

    version = "unknown"
    with suppress(metadata.PackageNotFoundError):
        version = metadata.version("ros-jazzy-rclpy")
    return [
        ("distribution name", os.environ.get("ROS_DISTRO", "jazzy")),
        ("distribution type", "ros2"),
        ("rclpy", version),
        ("domain", os.environ.get("ROS_DOMAIN_ID", "0")),
        ("discovery range", os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET")),
    ]


def _middleware() -> str:
    return os.environ.get("RMW_IMPLEMENTATION") or "rmw_fastrtps_cpp"


def _network_check() -> CheckupResult:
    flags = [_flags(device) for device in _devices()]
    errors = [] if any("LOOPBACK" in of_one for of_one in flags) else ["No loopback IP address is found."]
    warnings = []
    if all("LOOPBACK" in of_one for of_one in flags):
        warnings.append("Only loopback IP address is found.")
    if not any("MULTICAST" in of_one for of_one in flags):
        warnings.append("No multicast IP address is found.")
    return CheckupResult("network", errors, warnings)


def _network_items() -> Items:
    items: Items = []
    for device in _devices():
        items += [("inet", address) for address in _addresses(device.name)]
        items += [("device", device.name), ("flags", f"<{','.join(_flags(device))}>"), ("mtu", _read(device / "mtu"))]
    return items


def _devices() -> list[Path]:
    with suppress(OSError):
        return sorted(entry for entry in _DEVICES.iterdir() if (entry / "flags").is_file())
    return []


def _flags(device: Path) -> list[str]:
    number = int(_read(device / "flags") or "0", 16)
    return [name for bit, name in enumerate((*_FLAGS, *_MORE_FLAGS)) if number >> bit & 1]


def _read(path: Path) -> str:
    with suppress(OSError):
        return path.read_text(encoding="utf-8", errors="replace").strip()
    return ""


def _addresses(device: str) -> Iterator[str]:
    import fcntl

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as asking, suppress(OSError):
        reply = fcntl.ioctl(asking.fileno(), _GET_ADDRESS, struct.pack("256s", device.encode()[:15]))
        yield socket.inet_ntoa(reply[20:24])


def _topic_check(graph: Graph) -> CheckupResult:
    warnings = []
    for topic, ends in sorted(graph.endpoints.items()):
        if topic in _OF_EVERY_NODE or bool(ends.publishers) == bool(ends.subscriptions):
            continue
        there, missing = ("Publisher", "subscriber") if ends.publishers else ("Subscriber", "publisher")
        warnings.append(f"{there} without {missing} detected on {topic}.")
    return CheckupResult("topic", [], warnings)


def _topic_items(graph: Graph) -> Items:
    items: Items = []
    for topic, ends in sorted(graph.endpoints.items()):
        if topic not in _OF_EVERY_NODE:
            items.append(("topic", topic))
            items.append(("publisher count", str(len(ends.publishers))))
            items.append(("subscriber count", str(len(ends.subscriptions))))
    return items or [("topic", "none"), ("publisher count", "0"), ("subscriber count", "0")]


def _qos_check(graph: Graph) -> CheckupResult:
    found = CheckupResult("middleware", [], [])
    for topic, publisher, subscription in _pairs(graph):
        severity, reason = _compatibility(publisher, subscription)
        if severity != "OK":
            said = f"QoS compatibility {severity} found on topic '{topic}': {reason}"
            (found.errors if severity == "error" else found.warnings).append(said)
    return found


def _qos_items(graph: Graph) -> Items:
    items: Items = []
    for topic, publisher, subscription in _pairs(graph):
        severity, reason = _compatibility(publisher, subscription)
        items.append(("topic [type]", f"{topic} [{publisher['topic_type']}]"))
        items.append(("publisher node", publisher["node_name"]))
        items.append(("subscriber node", subscription["node_name"]))
        items.append(("compatibility status", reason if severity != "OK" else "OK"))
    return items or [("compatibility status", "No publisher/subscriber pairs found")]


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

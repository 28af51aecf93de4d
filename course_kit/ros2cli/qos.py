"""Quality of service from the command line, or taken from who is on the topic already."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros2cli.errors import CommandError

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo

_PROFILES = ("system_default", "sensor_data", "services_default", "parameters", "parameter_events", "default")
_POLICIES = {
    "reliability": ("reliable", "best_effort", "system_default"),
    "durability": ("volatile", "transient_local", "system_default"),
    "history": ("keep_last", "keep_all", "system_default"),
}


def add_qos(verb: ArgumentParser) -> None:
    """The options; see "Quality of Service settings" among the ROS 2 concepts."""
    group = verb.add_argument_group("quality of service")
    group.add_argument("--qos-profile", choices=_PROFILES, metavar="PROFILE", help=", ".join(_PROFILES))
    group.add_argument("--qos-depth", type=int, metavar="N", help="messages kept")
    for policy, values in _POLICIES.items():
        group.add_argument(f"--qos-{policy}", choices=values, metavar=policy.upper(), help=", ".join(values))


def for_publishing(options: Namespace) -> QoSProfile:
    """The profile the options ask for; the default one otherwise."""
    return _chosen(options, None)


def for_listening(options: Namespace, publishers: list[TopicEndpointInfo]) -> QoSProfile:
    """The profile the options ask for; where they are silent, one that matches all `publishers`."""
    from course_kit.ros.topic import as_offered

    return _chosen(options, as_offered(keepers=publishers))


def _chosen(options: Namespace, otherwise: QoSProfile | None) -> QoSProfile:
    from rclpy.qos import (
        DurabilityPolicy,
        HistoryPolicy,
        QoSPresetProfiles,
        QoSProfile,
        ReliabilityPolicy,
        qos_profile_system_default,
    )

    profile = QoSProfile(depth=10)
    if options.qos_profile == "system_default":
        profile = qos_profile_system_default
    elif options.qos_profile not in {None, "default"}:
        profile = QoSPresetProfiles.get_from_short_key(options.qos_profile)
    elif options.qos_profile is None and otherwise is not None:
        profile = otherwise
    profile = QoSProfile(
        depth=profile.depth,
        history=profile.history,
        reliability=profile.reliability,
        durability=profile.durability,
    )
    if options.qos_depth is not None:
        if options.qos_depth < 0:
            raise CommandError(f"--qos-depth has to be a number of messages, not {options.qos_depth}.")
        profile.depth = options.qos_depth
    for name, policy in (
        ("reliability", ReliabilityPolicy),
        ("durability", DurabilityPolicy),
        ("history", HistoryPolicy),
    ):
        if wanted := getattr(options, f"qos_{name}"):
            setattr(profile, name, policy[wanted.upper()])
    return profile

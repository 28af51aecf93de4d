"""Quality of service that fits who is on a topic already."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.qos import QoSProfile
    from rclpy.topic_endpoint_info import TopicEndpointInfo


def as_offered(depth: int = 10, keepers: Sequence[TopicEndpointInfo] = ()) -> QoSProfile:
    """A profile for a subscription that connects with all publishers that are on the topic when it is made."""
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    local = bool(keepers) and all(one.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for one in keepers)
    durability = DurabilityPolicy.TRANSIENT_LOCAL if local else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_AVAILABLE, durability=durability)

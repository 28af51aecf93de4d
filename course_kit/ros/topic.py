"""With what the ends of topics are made: quality of service, and which events they hear of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rclpy.topic_endpoint_info import TopicEndpointInfo

# Unless they are switched off these cost at each turn; they log that the other side's quality of service does not fit.
NO_SUBSCRIPTION_EVENTS = SubscriptionEventCallbacks(use_default_callbacks=False)
NO_PUBLISHER_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)


def as_offered(depth: int = 10, keepers: Sequence[TopicEndpointInfo] = ()) -> QoSProfile:
    """A profile for a subscription that connects with all publishers that are on the topic when it is made."""
    local = bool(keepers) and all(end.qos_profile.durability == DurabilityPolicy.TRANSIENT_LOCAL for end in keepers)
    durability = DurabilityPolicy.TRANSIENT_LOCAL if local else DurabilityPolicy.VOLATILE
    return QoSProfile(depth=depth, reliability=ReliabilityPolicy.BEST_AVAILABLE, durability=durability)

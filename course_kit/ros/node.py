"""The kit's own nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rclpy.context import Context
    from rclpy.node import Node


def quiet_node(name: str, context: Context) -> Node:
    """A node with nothing on it: what nobody can call, nobody can call wrongly, and it costs nothing at each turn."""
    from rclpy.node import Node
    from rclpy.parameter import Parameter

    return Node(
        name,
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=False,
        # rclpy leaves this service on the graph when the node is destroyed but its context lives on.
        parameter_overrides=[Parameter("start_type_description_service", value=False)],
    )

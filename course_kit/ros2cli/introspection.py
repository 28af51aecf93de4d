"""`ros2 service echo`: what clients and server of a service send, where they tell (service introspection, REP 2012)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.ros2cli import types
from course_kit.ros2cli.listening import Listener
from course_kit.ros2cli.text import dumped, layout_of, to_csv, to_plain

if TYPE_CHECKING:
    from argparse import Namespace

    from course_kit.ros2cli.session import Session

_TOPIC = "/_service_event"


def echo(options: Namespace, session: Session, service: str, service_type: str) -> None:
    """Print what is sent, for as long as something comes."""
    event = types.find_type(service_type, "srv").Event
    layout = layout_of(options)
    listener = Listener(options, session, f"{service}{_TOPIC}")
    subscription = listener.subscribe_to(event, "services_default")
    if not session.wait_on_graph(lambda: subscription.get_publisher_count() > 0, types.LOOK_S):
        print(
            f"No publishers on topic '{service}{_TOPIC}'; is service introspection on the client or server enabled?",
            flush=True,
        )
    words = {number: name for name, number in _kinds(event).items()}
    while True:
        message = listener.next().message
        if options.csv:
            print(to_csv(message, layout), flush=True)
            continue
        plain = to_plain(message, layout)
        plain["info"]["event_type"] = words.get(plain["info"]["event_type"], plain["info"]["event_type"])
        print(f"{dumped(plain, layout)}---", flush=True)


def _kinds(event: Any) -> dict[str, int]:
    """The constants of service_msgs/msg/ServiceEventInfo."""
    info = type(event().info)
    return {
        name: getattr(info, name) for name in ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")
    }

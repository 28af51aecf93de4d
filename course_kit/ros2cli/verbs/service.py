"""`ros2 service`: list, type, info, find, echo, call."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.graph import visible_names
from course_kit.ros2cli.parser import (
    add_graph_options,
    add_named,
    add_patience,
    add_timeout,
    add_values,
    add_verbs,
)
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.text import add_layout, dump_yaml, layout_of, to_csv, to_plain
from course_kit.ros2cli.verbs._listing import (
    add_about,
    add_find,
    add_list,
    add_type,
    checked_name,
    graph_of,
    print_names,
    types_of_existing,
)

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros.service import ServiceClient

_EVENTS = "/_service_event"
_KINDS = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")  # of ServiceEventInfo


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    add_graph_options(add_list(verbs, "service", _list))
    add_type(verbs, "service", lambda graph: graph.services)
    add_graph_options(add_about(verbs, "service", "info", _info, "Show the type of a service and how many use it"))
    add_find(verbs, "service", lambda graph: graph.services)
    _add_echo(add_about(verbs, "service", "echo", _echo, "Show what clients and server of a service send"))
    call = add_about(verbs, "service", "call", _call, "Call a service")
    add_named(call, "service_type", "service_types", help="such as std_srvs/srv/SetBool or std_srvs/SetBool")
    add_values(call, "values", "the request's fields as YAML, such as '{a: 1, b: 2}'")
    call.add_argument("-r", "--rate", type=float, metavar="N", help="call again and again, N times a second")
    add_timeout(call, "seconds to wait for the service, and for its answer, at most")


def _add_echo(verb: ArgumentParser) -> None:
    add_named(verb, "service_type", "service_types", nargs="?", help="found automatically if left out")
    add_layout(verb)
    add_patience(verb)


def _list(options: Namespace, session: Session) -> None:
    print_names(visible_names(graph_of(options, session).services, hidden_too=options.hidden), options)


def _info(options: Namespace, session: Session) -> None:
    name = checked_name(options.service_name)
    graph = graph_of(options, session)
    types = types_of_existing("service", name, graph.services)
    clients, servers = graph.counts[name]
    print(f"Type: {types[0] if len(types) == 1 else types}")
    print(f"Clients count: {clients}")
    print(f"Services count: {servers}")


def _echo(options: Namespace, session: Session) -> None:
    """Print what is sent, for as long as something comes: where they tell it (service introspection, REP 2012)."""
    from course_kit.ros2cli import values

    name = checked_name(options.service_name)
    kind = options.service_type
    if kind is None:
        kind = types_of_existing("service", name, session.observe(options.timeout or values.LOOK_S).services)[0]
    from course_kit.ros2cli.listening import Listener  # with rclpy, which the session makes ready first

    event = values.find_type(kind, "srv").Event
    layout = layout_of(options)
    listener = Listener(options, session, f"{name}{_EVENTS}")
    subscription = listener.subscribe_to(event, "services_default")
    if not session.wait_on_graph(lambda: subscription.get_publisher_count() > 0, values.LOOK_S):
        print(
            f"No publishers on topic '{name}{_EVENTS}'; is service introspection on the client or server enabled?",
            flush=True,
        )
    info = type(event().info)
    words = {getattr(info, word): word for word in _KINDS}
    while True:
        message = listener.next_message().message
        if options.csv:
            print(to_csv(message, layout), flush=True)
            continue
        plain = to_plain(message, layout)
        plain["info"]["event_type"] = words.get(plain["info"]["event_type"], plain["info"]["event_type"])
        print(f"{dump_yaml(plain, layout)}---", flush=True)


def _call(options: Namespace, session: Session) -> None:
    from course_kit.ros.service import ServiceClient
    from course_kit.ros2cli import values

    if options.rate is not None and options.rate <= 0:
        raise CommandError(f"--rate must be a number above 0, not {options.rate:g}.")
    name = checked_name(options.service_name)
    node = session.node  # before the type is imported: the graph is being discovered meanwhile
    service_type = values.find_type(options.service_type, "srv")
    request = service_type.Request()
    values.fill_message(request, values.read_typed(options, "values"), f"{type_name(service_type)}_Request")
    client = ServiceClient(node, service_type, name)
    print("waiting for service to become available...", flush=True)
    _wait_for_server(client, options.timeout, session)
    while True:
        print(f"requester: making request: {request!r}\n", flush=True)
        print(f"response:\n{session.answer_of(client, request, options.timeout, name)!r}\n", flush=True)
        if options.rate is None:
            return
        time.sleep(1.0 / options.rate)


def _wait_for_server(client: ServiceClient, timeout: float, session: Session) -> None:
    """Wait until a server is there."""
    node, name, wanted = session.node, client.name, client.type_name
    others: list[str] = []

    def is_ready() -> bool:
        if client.is_ready():
            return True
        # Our own client stands on the graph with its type, so only another type tells something.
        others[:] = [found for found in dict(node.get_service_names_and_types()).get(name, []) if found != wanted]
        return bool(others) and node.count_services(name) > 0

    if not session.wait_on_graph(is_ready, timeout):
        services = {found for found, _ in node.get_service_names_and_types()} - {name}
        raise CommandError(f"No service {name} within {timeout:g} s.{did_you_mean(name, services)}")
    if not client.is_ready():
        raise CommandError(f"{name} is a service of the type {others[0]}, not {wanted}.")

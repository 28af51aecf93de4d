"""`ros2 service`: list, type, info, find, call."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph import visible
from course_kit.ros2cli.parser import add_graph_options, add_named, add_timeout, add_verb, add_verbs
from course_kit.ros2cli.verbs._listing import checked_name, graph_of, print_names

if TYPE_CHECKING:
    import argparse

    from course_kit.ros2cli.session import Session


def add_to(place: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = add_verb(verbs, "list", _list, "List the services on the graph")
    listed.add_argument("-t", "--show-types", action="store_true", help="with their types")
    listed.add_argument("-c", "--count-services", action="store_true", help="only how many there are")
    listed.add_argument("-a", "--include-hidden-services", action="store_true", help="hidden ones too, as of actions")
    add_graph_options(listed)
    for name, run, purpose in (
        ("type", _type, "Show the type of a service"),
        ("info", _info, "Show the type of a service and how many use it"),
    ):
        verb = add_verb(verbs, name, run, purpose)
        add_named(verb, "service_name", "services", help="such as /add_two_ints")
        add_graph_options(verb)
    find = add_verb(verbs, "find", _find, "List the services of a type")
    add_named(find, "service_type", "service_types", help="such as std_srvs/srv/SetBool")
    find.add_argument("-c", "--count-services", action="store_true", help="only how many there are")
    find.add_argument("-a", "--include-hidden-services", action="store_true", help="hidden ones too")
    add_graph_options(find)
    call = add_verb(verbs, "call", _call, "Call a service")
    add_named(call, "service_name", "services", help="such as /add_two_ints")
    add_named(call, "service_type", "service_types", help="such as std_srvs/srv/SetBool or std_srvs/SetBool")
    call.add_argument("values", nargs="?", help="the request's fields as YAML, such as '{a: 1, b: 2}'")
    call.add_argument("-r", "--rate", type=float, metavar="N", help="call again and again, N times a second")
    add_timeout(call, "seconds to wait for the service, and for its answer, at most")


def _list(options: Any, session: Session) -> None:
    services = visible(graph_of(options, session).services, hidden_too=options.include_hidden_services)
    print_names(services, types=options.show_types, count=options.count_services)


def _type(options: Any, session: Session) -> None:
    name = checked_name(options.service_name)
    for service_type in _existing(name, graph_of(options, session).services):
        print(service_type)


def _info(options: Any, session: Session) -> None:
    name = checked_name(options.service_name)
    graph = graph_of(options, session)
    types = _existing(name, graph.services)
    clients, servers = graph.counts[name]
    print(f"Type: {types[0] if len(types) == 1 else types}")
    print(f"Clients count: {clients}")
    print(f"Services count: {servers}")


def _find(options: Any, session: Session) -> None:
    services = visible(graph_of(options, session).services, hidden_too=options.include_hidden_services)
    wanted = _long(options.service_type)
    found = {name: types for name, types in services.items() if wanted in types}
    print_names(found, types=False, count=options.count_services)


def _existing(name: str, services: dict[str, list[str]]) -> list[str]:
    if name not in services:
        raise CommandError(f"Unknown service '{name}'.{did_you_mean(name, services)}")
    return services[name]


def _long(type_name: str) -> str:
    package, _, name = type_name.partition("/")
    return type_name if "/" in name else f"{package}/srv/{name}"


def _call(options: Any, session: Session) -> None:
    from course_kit.ros2cli import types, values

    if options.rate is not None and options.rate <= 0:
        raise CommandError(f"--rate has to be a number above 0, not {options.rate:g}.")
    name = checked_name(options.service_name)
    node = session.node  # before the type is imported: the graph is being discovered meanwhile
    service_type = types.find_type(options.service_type, "srv")
    request = service_type.Request()
    values.fill(request, options.values, f"{type_name(service_type)}_Request")
    client = node.create_client(service_type, name)
    print("waiting for service to become available...", flush=True)
    _wait_for_server(client, name, type_name(service_type), options.timeout, session)
    while True:
        print(f"requester: making request: {request!r}\n", flush=True)
        print(f"response:\n{session.answer_of(client, request, options.timeout, name)!r}\n", flush=True)
        if options.rate is None:
            return
        time.sleep(1.0 / options.rate)


def _wait_for_server(client: Any, name: str, type_name: str, timeout: float, session: Session) -> None:
    """Wait until a server is there.

    Raises:
        CommandError: none came, or the name belongs to a service of another type.
    """
    node = session.node
    others: list[str] = []

    def is_ready() -> bool:
        if client.service_is_ready():
            return True
        # Our own client stands on the graph with its type, so only another type tells something.
        others[:] = [found for found in dict(node.get_service_names_and_types()).get(name, []) if found != type_name]
        return bool(others) and node.count_services(name) > 0

    if not session.wait_on_graph(is_ready, timeout):
        services = {found for found, _ in node.get_service_names_and_types()} - {name}
        raise CommandError(f"No service {name} within {timeout:g} s.{did_you_mean(name, services)}")
    if not client.service_is_ready():
        raise CommandError(f"{name} is a service of the type {others[0]}, not {type_name}.")

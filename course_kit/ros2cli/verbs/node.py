"""`ros2 node`: list, info."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from course_kit.ros.names import did_you_mean, is_hidden
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph import actions_among, visible
from course_kit.ros2cli.parser import add_graph_options, add_named, add_verb, add_verbs
from course_kit.ros2cli.verbs._listing import checked_name, graph_of

if TYPE_CHECKING:
    import argparse

    from course_kit.ros2cli.graph import Names
    from course_kit.ros2cli.session import Session


def add_to(place: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = add_verb(verbs, "list", _list, "List the nodes on the graph")
    listed.add_argument("-a", "--all", action="store_true", help="hidden ones too")
    listed.add_argument("-c", "--count-nodes", action="store_true", help="only how many there are")
    add_graph_options(listed)
    info = add_verb(verbs, "info", _info, "Show what a node has")
    add_named(info, "node_name", "nodes", help="such as /robot")
    info.add_argument("--include-hidden", action="store_true", help="hidden topics, services and actions too")
    add_graph_options(info)


def _list(options: Any, session: Session) -> None:
    nodes = sorted(node for node in graph_of(options, session).nodes if options.all or not is_hidden(node))
    if options.count_nodes:
        print(len(nodes))
        return
    if len(set(nodes)) < len(nodes):
        sys.stderr.write(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which can have unintended "
            "side effects.\n"
        )
    for node in nodes:
        print(node)


def _info(options: Any, session: Session) -> None:
    name = checked_name(options.node_name)
    graph = graph_of(options, session)
    if name not in graph.entities:
        raise CommandError(f"Unable to find node '{name}'.{did_you_mean(name, graph.nodes)}")
    if (same := graph.nodes.count(name)) > 1:
        print(
            f'There are {same} nodes in the graph with the exact name "{name}". '
            "You are seeing information about only one of them."
        )
    has = graph.entities[name]
    print(name)
    for title, names in (
        ("Subscribers", has.subscribers),
        ("Publishers", has.publishers),
        ("Service Servers", has.servers),
        ("Service Clients", has.clients),
        ("Action Servers", actions_among(has.publishers)),
        ("Action Clients", actions_among(has.subscribers)),
    ):
        _print_section(title, visible(names, hidden_too=options.include_hidden))


def _print_section(title: str, names: Names) -> None:
    print(f"  {title}:")
    print(*[f"    {name}: {', '.join(types)}" for name, types in names.items()], sep="\n")

"""`ros2 node`: list, info."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.ros.graph import CALLS, LISTENS, PUBLISHES, RUNS, SENDS_GOALS, SERVES
from course_kit.ros.names import did_you_mean, is_hidden
from course_kit.ros2cli.graph import visible_names
from course_kit.ros2cli.parser import add_graph_options, add_verb, add_verbs
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.verbs._listing import add_about, checked_name, graph_of

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace


_SECTIONS = {
    "Subscribers": LISTENS,
    "Publishers": PUBLISHES,
    "Service Servers": SERVES,
    "Service Clients": CALLS,
    "Action Servers": RUNS,
    "Action Clients": SENDS_GOALS,
}


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = add_verb(verbs, "list", _list, "List the nodes on the graph")
    listed.add_argument("-a", "--all", action="store_true", help="hidden ones too")
    listed.add_argument("-c", "--count-nodes", dest="count", action="store_true", help="only how many there are")
    add_graph_options(listed)
    info = add_about(verbs, "node", "info", _info, "Show what a node has")
    info.add_argument("--include-hidden", action="store_true", help="hidden topics, services and actions too")
    add_graph_options(info)


def _list(options: Namespace, session: Session) -> None:
    nodes = sorted(node for node in graph_of(options, session).nodes if options.all or not is_hidden(node))
    if options.count:
        print(len(nodes))
        return
    if len(set(nodes)) < len(nodes):
        sys.stderr.write(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, which can have unintended "
            "side effects.\n"
        )
    for node in nodes:
        print(node)


def _info(options: Namespace, session: Session) -> None:
    name = checked_name(options.node_name)
    graph = graph_of(options, session)
    if name not in graph.nodes:
        raise CommandError(f"Unable to find node '{name}'.{did_you_mean(name, graph.nodes)}")
    if (same := graph.nodes.count(name)) > 1:
        print(
            f'There are {same} nodes in the graph with the exact name "{name}". '
            "You are seeing information about only one of them."
        )
    print(name)
    for title, role in _SECTIONS.items():
        print(f"  {title}:")
        names = visible_names(graph.channels_of(name, role), hidden_too=options.include_hidden)
        print(*[f"    {name}: {', '.join(types)}" for name, types in names.items()], sep="\n")

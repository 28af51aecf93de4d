"""`ros2 action`: list, type, info, send_goal."""

from __future__ import annotations

import sys
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
    listed = add_verb(verbs, "list", _list, "List the actions on the graph")
    listed.add_argument("-t", "--show-types", action="store_true", help="with their types")
    listed.add_argument("-c", "--count-actions", action="store_true", help="only how many there are")
    add_graph_options(listed)
    kind = add_verb(verbs, "type", _type, "Show the type of an action")
    add_named(kind, "action_name", "actions", help="such as /fibonacci")
    add_graph_options(kind)
    info = add_verb(verbs, "info", _info, "Show who serves an action and who uses it")
    add_named(info, "action_name", "actions", help="such as /fibonacci")
    info.add_argument("-t", "--show-types", action="store_true", help="with the types")
    info.add_argument("-c", "--count", action="store_true", help="only how many there are")
    add_graph_options(info)
    goal = add_verb(verbs, "send_goal", _send_goal, "Send a goal; Ctrl-C cancels it")
    add_named(goal, "action_name", "actions", help="such as /fibonacci")
    add_named(goal, "action_type", "action_types", help="such as example_interfaces/action/Fibonacci")
    goal.add_argument("goal", help="the goal's fields as YAML, such as '{order: 5}'")
    goal.add_argument("-f", "--feedback", action="store_true", help="show the feedback as it comes")
    add_timeout(goal, "seconds to wait at most for the server, its decision, and between two signs of life")


def _list(options: Any, session: Session) -> None:
    print_names(visible(graph_of(options, session).actions()), types=options.show_types, count=options.count_actions)


def _type(options: Any, session: Session) -> None:
    name = checked_name(options.action_name)
    actions = graph_of(options, session).actions()
    if name not in actions:
        raise CommandError(f"Unknown action '{name}'.{did_you_mean(name, actions)}")
    for action_type in actions[name]:
        print(action_type)


def _info(options: Any, session: Session) -> None:
    name = checked_name(options.action_name)
    graph = graph_of(options, session)
    print(f"Action: {name}")
    for title, nodes in (("clients", graph.action_clients(name)), ("servers", graph.action_servers(name))):
        print(f"Action {title}: {len(nodes)}")
        if not options.count:
            for node, types in sorted(nodes.items()):
                print(f"    {node} [{', '.join(types)}]" if options.show_types else f"    {node}")
    if name not in graph.actions() and (hint := did_you_mean(name, graph.actions())):
        sys.stderr.write(f"There is no action {name}.{hint}\n")  # zeros and exit code 0 are the real command's


def _send_goal(options: Any, session: Session) -> None:
    from course_kit.ros2cli import types, values
    from course_kit.ros2cli.goal import SentGoal

    name = checked_name(options.action_name)
    node = session.node  # before the type is imported: the graph is being discovered meanwhile
    action_type = types.find_type(options.action_type, "action")
    goal = action_type.Goal()
    values.fill(goal, options.goal, f"{type_name(action_type)}_Goal")
    sending = SentGoal(session, node, action_type, name, options.timeout)
    try:
        sending.run(goal, show_feedback=options.feedback)
    finally:
        sending.close()

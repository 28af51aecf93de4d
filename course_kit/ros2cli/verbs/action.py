"""`ros2 action`: list, type, info, send_goal."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.ros.graph import RUNS, SENDS_GOALS
from course_kit.ros.messages import type_name
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.graph import Graph, visible
from course_kit.ros2cli.parser import add_graph_options, add_named, add_timeout, add_values, add_verbs
from course_kit.ros2cli.verbs._listing import add_about, add_list, add_type, checked_name, graph_of, print_names

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros2cli.session import Session


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    add_graph_options(add_list(verbs, "action", _list, hidden=False))
    add_type(verbs, "action", Graph.actions)
    info = add_about(verbs, "action", "info", _info, "Show who serves an action and who uses it")
    info.add_argument("-t", "--show-types", action="store_true", help="with the types")
    info.add_argument("-c", "--count", action="store_true", help="only how many there are")
    add_graph_options(info)
    goal = add_about(verbs, "action", "send_goal", _send_goal, "Send a goal; Ctrl-C cancels it")
    add_named(goal, "action_type", "action_types", help="such as example_interfaces/action/Fibonacci")
    add_values(goal, "goal", "the goal's fields as YAML, such as '{order: 5}'")
    goal.add_argument("-f", "--feedback", action="store_true", help="show the feedback as it comes")
    add_timeout(goal, "seconds to wait at most for the server, its decision, and between two signs of life")


def _list(options: Namespace, session: Session) -> None:
    print_names(visible(graph_of(options, session).actions()), options)


def _info(options: Namespace, session: Session) -> None:
    name = checked_name(options.action_name)
    graph = graph_of(options, session)
    print(f"Action: {name}")
    for title, nodes in (("clients", graph.on(name, SENDS_GOALS)), ("servers", graph.on(name, RUNS))):
        print(f"Action {title}: {len(nodes)}")
        if not options.count:
            for node, types in sorted(nodes.items()):
                print(f"    {node} [{', '.join(types)}]" if options.show_types else f"    {node}")
    if name not in graph.actions() and (hint := did_you_mean(name, graph.actions())):
        sys.stderr.write(f"There is no action {name}.{hint}\n")  # zeros and exit code 0 are the real command's


def _send_goal(options: Namespace, session: Session) -> None:
    from course_kit.ros2cli import values
    from course_kit.ros2cli.goal import SentGoal

    name = checked_name(options.action_name)
    node = session.node  # before the type is imported: the graph is being discovered meanwhile
    action_type = values.find_type(options.action_type, "action")
    goal = action_type.Goal()
    values.fill(goal, values.typed(options, "goal"), f"{type_name(action_type)}_Goal")
    sending = SentGoal(session, node, action_type, name, options.timeout)
    try:
        sending.run(goal, show_feedback=options.feedback)
    finally:
        sending.close()

"""Tab completion: verbs, options, names on the graph and types, through argcomplete.

A shell asks after `eval "$(register-python-argcomplete ros2)"` (argcomplete's documentation).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argparse import Namespace
    from collections.abc import Callable, Iterable

    from course_kit.ros2cli.graph import Graph, Names

_PATIENCE = 2.0  # seconds; somebody is waiting with a finger on the Tab key


def list_candidates(wanted: str, given: Namespace, begun: str) -> list[str]:
    """What may stand where `wanted` is named, behind the words given so far; `begun` is the word being typed."""
    from course_kit import interfaces
    from course_kit.launch import executables

    def types(kind: str, names_of: Callable[[Graph], Names], argument: str) -> list[str]:
        """The type of what was named before; all of its kind when that is not on the graph."""
        return names_of(_graph()).get(getattr(given, argument, None) or "") or interfaces.types(kind=kind)

    found: dict[str, Callable[[], list[str]]] = {
        "services": lambda: _visible_names(_graph().services),
        "topics": lambda: _visible_names(_graph().topics),
        "actions": lambda: sorted(_graph().actions()),
        "nodes": lambda: _visible_names(_graph().nodes),
        "parameters": lambda: _parameters(given.node_name),
        "service_types": lambda: types("srv", lambda graph: graph.services, "service_name"),
        "action_types": lambda: types("action", lambda graph: graph.actions(), "action_name"),
        "message_types": lambda: types("msg", lambda graph: graph.topics, "topic_name"),
        "all_types": interfaces.types,
        "interface_packages": interfaces.packages,
        "run_packages": executables.find_packages,
        "run_executables": lambda: executables.list_executables(given.package_name),
        "launch_files": lambda: _launch_files(begun),
    }
    return found[wanted]()


def _parameters(node_name: str) -> list[str]:
    from course_kit.ros import parameters
    from course_kit.ros.names import from_root
    from course_kit.ros2cli.parameters import ParameterClient
    from course_kit.ros2cli.session import Session

    session = Session(visits=True)
    try:
        client = ParameterClient(session, from_root(node_name), _PATIENCE)
        return sorted(client.ask(parameters.ask_names()))
    finally:
        session.close()


def _launch_files(begun: str) -> list[str]:
    from pathlib import Path

    folder, _, name = begun.rpartition("/")
    found = [*Path(folder or ".").glob(f"{name}*.launch.py"), *Path(folder or ".").glob(f"{name}*/*.launch.py")]
    return [str(path) for path in found]


def _graph() -> Graph:
    from course_kit.ros2cli.daemon import graph_for
    from course_kit.ros2cli.session import Session

    session = Session(visits=True)
    try:
        return graph_for(session, _PATIENCE)
    finally:
        session.close()


def _visible_names(names: Iterable[str]) -> list[str]:
    from course_kit.ros.names import is_hidden

    return sorted({name for name in names if not is_hidden(name)})

"""Tab completion: verbs, options, names on the graph and types, through argcomplete.

A shell asks after `eval "$(register-python-argcomplete ros2)"` (argcomplete's documentation).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import argparse
    from argparse import Namespace
    from collections.abc import Iterable

    from course_kit.ros2cli.graph import Graph

_PATIENCE = 2.0  # seconds; somebody is waiting with a finger on the Tab key


def complete(parser: argparse.ArgumentParser) -> None:
    """Answer the shell what may stand next in the parser's command line; does not return."""
    import argcomplete

    argcomplete.autocomplete(parser, always_complete_options=False)


def services(**about: object) -> list[str]:
    """Service names, without the hidden ones."""
    del about
    return _shown(_graph().services)


def topics(**about: object) -> list[str]:
    """Topic names, without the hidden ones."""
    del about
    return _shown(_graph().topics)


def actions(**about: object) -> list[str]:
    """Action names."""
    del about
    return sorted(_graph().actions())


def nodes(**about: object) -> list[str]:
    """Node names, without the hidden ones."""
    del about
    return _shown(_graph().nodes)


def parameters(*, parsed_args: Namespace, **about: object) -> list[str]:
    """The parameters of the node named before."""
    del about
    from course_kit.ros import parameters as of_a_node
    from course_kit.ros.names import from_root
    from course_kit.ros2cli.parameters import ParameterClient
    from course_kit.ros2cli.session import Session

    session = Session(visits=True)
    try:
        client = ParameterClient(session, from_root(parsed_args.node_name), _PATIENCE)
        return sorted(client.ask(of_a_node.names()))
    finally:
        session.close()


def service_types(*, parsed_args: Namespace, **about: object) -> list[str]:
    """The type of the service named before; all service types when it is not on the graph."""
    del about
    return _types("srv", _graph().services.get(getattr(parsed_args, "service_name", None) or "", []))


def action_types(*, parsed_args: Namespace, **about: object) -> list[str]:
    """The same for actions."""
    del about
    return _types("action", _graph().actions().get(getattr(parsed_args, "action_name", None) or "", []))


def message_types(*, parsed_args: Namespace, **about: object) -> list[str]:
    """The same for topics."""
    del about
    return _types("msg", _graph().topics.get(getattr(parsed_args, "topic_name", None) or "", []))


def all_types(**about: object) -> list[str]:
    """The names of all interfaces."""
    del about
    from course_kit import interfaces

    return interfaces.types()


def interface_packages(**about: object) -> list[str]:
    """The packages that have interfaces."""
    del about
    from course_kit import interfaces

    return interfaces.packages()


def run_packages(**about: object) -> list[str]:
    """The packages that have programs."""
    del about
    from course_kit.launch.executables import packages

    return packages()


def run_executables(*, parsed_args: Namespace, **about: object) -> list[str]:
    """The programs of the package named before."""
    del about
    from course_kit.launch.executables import executables

    return executables(parsed_args.package_name)


def launch_files(*, prefix: str, **about: object) -> list[str]:
    """Launch files at the path typed so far."""
    del about
    from pathlib import Path

    folder, _, begun = prefix.rpartition("/")
    found = [*Path(folder or ".").glob(f"{begun}*.launch.py"), *Path(folder or ".").glob(f"{begun}*/*.launch.py")]
    return [str(path) for path in found]


def _graph() -> Graph:
    from course_kit.ros2cli.daemon import graph_for
    from course_kit.ros2cli.session import Session

    session = Session(visits=True)
    try:
        return graph_for(session, _PATIENCE)
    finally:
        session.close()


def _shown(names: Iterable[str]) -> list[str]:
    from course_kit.ros.names import is_hidden

    return sorted({name for name in names if not is_hidden(name)})


def _types(kind: str, known: list[str]) -> list[str]:
    from course_kit import interfaces

    return known or interfaces.types(kind=kind)

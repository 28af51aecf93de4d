"""What the verbs about services, actions, topics and nodes share: their arguments, the graph, and names on it."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from course_kit.ros.names import did_you_mean, from_root
from course_kit.ros2cli.daemon import graph_for
from course_kit.ros2cli.graph import visible_names
from course_kit.ros2cli.parser import add_graph_options, add_named, add_verb
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable

    from course_kit.ros2cli.graph import Graph, Names
    from course_kit.ros2cli.parser import Run, Verbs

_NAME = re.compile(r"(?:/?(?:[A-Za-z_~]\w*)(?:/[A-Za-z_]\w*)*|/)")
_TYPES = {"service": "std_srvs/srv/SetBool", "topic": "std_msgs/msg/String"}
_EXAMPLES = {"service": "/add_two_ints", "action": "/fibonacci", "topic": "/chatter", "node": "/robot"}


def add_list(verbs: Verbs, kind: str, run: Run, *, hidden: bool = True) -> ArgumentParser:
    """Add the verb `list` of services, actions or topics."""
    verb = add_verb(verbs, "list", run, f"List the {kind}s on the graph")
    verb.add_argument("-t", "--show-types", action="store_true", help="with their types")
    verb.add_argument("-c", f"--count-{kind}s", dest="count", action="store_true", help="only how many there are")
    if hidden:
        verb.add_argument(
            "-a",
            f"--include-hidden-{kind}s",
            dest="hidden",
            action="store_true",
            help="also hidden ones, such as those of actions",
        )
    return verb


def add_about(verbs: Verbs, kind: str, name: str, run: Run, purpose: str) -> ArgumentParser:
    """Add a verb that is about one service, action, topic or node."""
    verb = add_verb(verbs, name, run, purpose)
    add_of_kind(verb, kind)
    return verb


def add_of_kind(verb: ArgumentParser, kind: str) -> None:
    """The argument that names a service, an action, a topic or a node."""
    add_named(verb, f"{kind}_name", f"{kind}s", help=f"such as {_EXAMPLES[kind]}")


def add_type(verbs: Verbs, kind: str, names_of: Callable[[Graph], Names]) -> None:
    """Add the verb `type`."""

    def run(options: Namespace, session: Session) -> None:
        name = checked_name(getattr(options, f"{kind}_name"))
        print(*types_of_existing(kind, name, names_of(graph_of(options, session))), sep="\n")

    article = "an" if kind == "action" else "a"
    add_graph_options(add_about(verbs, kind, "type", run, f"Show the type of {article} {kind}"))


def add_find(verbs: Verbs, kind: str, names_of: Callable[[Graph], Names]) -> None:
    """Add the verb `find`, which lists what has a type."""
    part = {"service": "srv", "topic": "msg"}[kind]

    def run(options: Namespace, session: Session) -> None:
        package, _, name = getattr(options, f"{kind}_type").partition("/")
        wanted = f"{package}/{name}" if "/" in name else f"{package}/{part}/{name}"
        names = visible_names(names_of(graph_of(options, session)), hidden_too=options.hidden)
        print_names({name: its_types for name, its_types in names.items() if wanted in its_types}, options)

    verb = add_verb(verbs, "find", run, f"List the {kind}s of a type")
    completer = {"service": "service_types", "topic": "message_types"}[kind]
    add_named(verb, f"{kind}_type", completer, help=f"such as {_TYPES[kind]}")
    verb.add_argument("-c", f"--count-{kind}s", dest="count", action="store_true", help="only how many there are")
    verb.add_argument("-a", f"--include-hidden-{kind}s", dest="hidden", action="store_true", help="hidden ones too")
    add_graph_options(verb)


def types_of_existing(kind: str, name: str, names: Names) -> list[str]:
    """The types of what has this name."""
    if name not in names:
        raise CommandError(f"Unknown {kind} '{name}'.{did_you_mean(name, names)}")
    return names[name]


def graph_of(options: Namespace, session: Session) -> Graph:
    """The graph as the options ask for it."""
    return graph_for(session, options.timeout, daemon=not options.no_daemon)


def print_names(names: Names, options: Namespace) -> None:
    """One name a line, with its types in brackets when asked for; or only how many there are."""
    if options.count:
        print(len(names))
        return
    for name, its_types in names.items():
        print(f"{name} [{', '.join(its_types)}]" if getattr(options, "show_types", False) else name)


def checked_name(name: str) -> str:
    """A graph name from the root."""
    if not _NAME.fullmatch(name):
        raise CommandError(
            f"{name!r} cannot be a name on the graph: parts begin with a letter, followed by letters, digits and _, "
            "with / between."
        )
    return from_root(name)

"""`ros2 interface`: list, show, package, packages, proto."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.parser import add_named, add_verb, add_verbs

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros2cli.session import Session

_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    for name, run, purpose in (
        ("list", _list, "List all interfaces there are"),
        ("packages", _packages, "List the packages that have interfaces"),
    ):
        verb = add_verb(verbs, name, run, purpose)
        _add_kinds(verb)
    show = add_verb(verbs, "show", _show, "Show the text of an interface")
    add_named(show, "type", "all_types", help="such as std_srvs/srv/SetBool; - reads it from stdin")
    which = show.add_mutually_exclusive_group()
    which.add_argument("--all-comments", action="store_true", help="also the comments of the messages inside it")
    which.add_argument("--no-comments", action="store_true", help="without comments and empty lines")
    package = add_verb(verbs, "package", _package, "List the interfaces of a package")
    _add_kinds(package)
    add_named(package, "package_name", "interface_packages", help="such as std_srvs")
    proto = add_verb(verbs, "proto", _proto, "Show an interface's values, ready to be filled in")
    add_named(proto, "type", "all_types", help="such as std_srvs/srv/SetBool")
    proto.add_argument("--no-quotes", action="store_true", help="without the quotes around it")


def _add_kinds(verb: ArgumentParser) -> None:
    verb.add_argument("-m", "--only-msgs", action="append_const", dest="kinds", const="msg", help="messages")
    verb.add_argument("-s", "--only-srvs", action="append_const", dest="kinds", const="srv", help="services")
    verb.add_argument("-a", "--only-actions", action="append_const", dest="kinds", const="action", help="actions")


def _list(options: Namespace, session: Session) -> None:
    del session
    from course_kit import interfaces

    for kind in options.kinds or list(_TITLES):
        print(f"{_TITLES[kind]}:")
        for name in interfaces.types(kind=kind):
            print(f"    {name}")


def _packages(options: Namespace, session: Session) -> None:
    del session
    from course_kit import interfaces

    for package in interfaces.packages():
        if not options.kinds or any(interfaces.types(package, kind) for kind in options.kinds):
            print(package)


def _package(options: Namespace, session: Session) -> None:
    del session
    from course_kit import interfaces

    if options.package_name not in (packages := interfaces.packages()):
        raise CommandError(f"Unknown package '{options.package_name}'.{did_you_mean(options.package_name, packages)}")
    for kind in options.kinds or list(_TITLES):
        for name in interfaces.types(options.package_name, kind):
            print(name)


def _show(options: Namespace, session: Session) -> None:
    del session
    from course_kit.ros2cli.definition import shown_lines

    name = sys.stdin.readline().strip() if options.type == "-" else options.type
    for line in shown_lines(name, comments=not options.no_comments, inner_comments=options.all_comments):
        print(line)


def _proto(options: Namespace, session: Session) -> None:
    del session
    from course_kit.ros2cli.definition import known
    from course_kit.ros2cli.text import to_yaml

    interface = known(options.type)
    part = getattr(interface, "Request", None) or getattr(interface, "Goal", None) or interface
    quote = "" if options.no_quotes else '"'
    text = to_yaml(part()) if part.get_fields_and_field_types() else ""
    print(f"{quote}{text}{quote}")

"""`ros2 interface`: list, show, package, packages, proto."""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING, TypeVar

from course_kit import interfaces
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.parser import add_named, add_verb, add_verbs
from course_kit.ros2cli.session import CommandError, Session

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace
    from collections.abc import Callable, Iterator


_INTEGERS = {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)}
_PRIMITIVES = _INTEGERS | {"bool", "byte", "char", "float32", "float64", "string", "wstring"}
_FIELD = re.compile(r"\s*(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]\w*")
_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}

T = TypeVar("T")


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
    for kind in options.kinds or list(_TITLES):
        print(f"{_TITLES[kind]}:")
        for name in interfaces.types(kind=kind):
            print(f"    {name}")


def _packages(options: Namespace, session: Session) -> None:
    del session
    for package in interfaces.packages():
        if not options.kinds or any(interfaces.types(package, kind) for kind in options.kinds):
            print(package)


def _package(options: Namespace, session: Session) -> None:
    del session
    if options.package_name not in (packages := interfaces.packages()):
        raise CommandError(f"Unknown package '{options.package_name}'.{did_you_mean(options.package_name, packages)}")
    for kind in options.kinds or list(_TITLES):
        for name in interfaces.types(options.package_name, kind):
            print(name)


def _show(options: Namespace, session: Session) -> None:
    del session
    name = sys.stdin.readline().strip() if options.type == "-" else options.type
    text = _find_interface(name, interfaces.text_of).rstrip("\n")
    for line in _lines(text, name.partition("/")[0], not options.no_comments, options.all_comments, ""):
        print(line)


def _proto(options: Namespace, session: Session) -> None:
    del session
    from course_kit.ros2cli.text import to_yaml

    interface = _find_interface(options.type, interfaces.get_type)
    part = getattr(interface, "Request", None) or getattr(interface, "Goal", None) or interface
    quote = "" if options.no_quotes else '"'
    text = to_yaml(part()) if part.get_fields_and_field_types() else ""
    print(f"{quote}{text}{quote}")


def _find_interface(name: str, find: Callable[[str], T]) -> T:
    """What `find` knows of any interface, msg, srv or action."""
    try:
        return find(name)
    except LookupError as problem:
        package = name.partition("/")[0]
        names = interfaces.types(package if package in interfaces.packages() else None)
        raise CommandError(f"Unknown interface '{name}'.{did_you_mean(name, names)}") from problem
    except ValueError as problem:
        raise CommandError(str(problem)) from problem


def _lines(text: str, package: str, comments: bool, inner_comments: bool, indent: str) -> Iterator[str]:
    from course_kit.interfaces.comments import split_comment

    for written in text.splitlines():
        code, _ = split_comment(written)
        line = written.rstrip() if comments else code
        if line or comments:
            yield f"{indent}{line}" if line else ""
        inner = _inner_type(code, package)
        if inner:
            inner_text = interfaces.text_of(inner).rstrip("\n")
            yield from _lines(inner_text, inner.partition("/")[0], inner_comments, inner_comments, f"{indent}\t")


def _inner_type(code: str, package: str) -> str | None:
    """The message a field is of, None for anything else."""
    field = _FIELD.match(code)
    if field is None or field["type"] in _PRIMITIVES:
        return None
    parts = field["type"].split("/")
    return f"{parts[0] if len(parts) > 1 else package}/msg/{parts[-1]}"

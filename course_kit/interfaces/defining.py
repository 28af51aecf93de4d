"""Defining an interface while Python runs."""

from __future__ import annotations

import importlib
import textwrap
import warnings
from pathlib import Path
from typing import Any, cast

from course_kit import environment
from course_kit.interfaces import finder, known_types, sources
from course_kit.interfaces.errors import InterfaceDefinitionError, InterfaceNotFoundError
from course_kit.interfaces.known_types import get_type, text_of
from course_kit.interfaces.parser import parse_definition, parse_type_name


def define(type_name: str, text: str) -> type[Any]:
    """Define a message, service or action, at once and for this checkout's other processes too.

    Defining a name again replaces it: who imports it from now on gets the new class, who holds the old one goes on
    with that. The text is saved below `environment.run_dir()`, where programs started later find it; a program that
    has imported the type already keeps it.

    Args:
        type_name: full name, such as "my_interfaces/srv/PersonInfo".
        text: what the .msg, .srv or .action file would hold; indented as a whole is fine.

    Returns:
        The class, as `from my_interfaces.srv import PersonInfo` gives it.

    Raises:
        InterfaceDefinitionError: the name or the text is not valid, or the package is not the learner's own.
    """
    name = parse_type_name(type_name)
    text = textwrap.dedent(text).rstrip() + "\n"
    owner = _other_owner(name.package)
    if owner is not None:
        return _require_unchanged(type_name, text, owner)
    cls = cast("type[Any]", finder.get_finder().library.define(name, text).find(name.name))
    _refuse_hidden_package(type_name, name.package)
    _save(Path(name.package, name.kind, f"{name.name}.{name.kind}"), text)
    return cls


def _other_owner(package: str) -> str | None:
    """What a package that is not the learner's belongs to."""
    if Path(sources.OWN_FOLDER, package).is_dir():
        return "comes with the course"
    return "is installed" if package in known_types.installed_packages() else None


def _require_unchanged(type_name: str, text: str, owner: str) -> type[Any]:
    """The existing type of somebody else's package, if the text says the same."""
    try:
        same = parse_definition(type_name, text) == parse_definition(type_name, text_of(type_name))
    except InterfaceNotFoundError:
        same = False
    if same:
        return get_type(type_name)
    package = type_name.partition("/")[0]
    expected = f"The package {package!r} {owner} and stays as it is: expected your own package, such as my_interfaces."
    raise InterfaceDefinitionError(type_name, 0, "", expected)


def _refuse_hidden_package(type_name: str, package: str) -> None:
    """Say so if Python would import something else by that name."""
    module = importlib.import_module(package)
    if not finder.is_live(module):
        places = [module.__file__] if getattr(module, "__file__", None) else list(getattr(module, "__path__", ["?"]))
        expected = f"Python imports {places[0]} for {package!r}: expected a package name that nothing else has."
        raise InterfaceDefinitionError(type_name, 0, "", expected)


def _save(path: Path, text: str) -> None:
    """Write the text where other processes look, whole or not at all."""
    folder = sources.saved_folder()
    try:
        if folder is None:
            raise OSError("there is no folder that can be written to")  # noqa: TRY301
        environment.write_atomically(Path(folder) / path, text, durable=False)
    except OSError as error:
        message = f"{path} is defined in this program only; other programs will not find it: {error}."
        warnings.warn(message, RuntimeWarning, stacklevel=3)

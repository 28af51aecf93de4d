"""`ros2 param`: list, get, set, describe, dump, load, delete."""

from __future__ import annotations

import re
import sys
import time
from typing import TYPE_CHECKING, Any

from course_kit.ros import parameters
from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.graph import visible_names
from course_kit.ros2cli.parameters import ParameterClient, load_parameters
from course_kit.ros2cli.parser import add_graph_options, add_named, add_verb, add_verbs
from course_kit.ros2cli.session import CommandError, Session
from course_kit.ros2cli.verbs._listing import add_of_kind, checked_name, graph_of

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros.messages import Message
    from course_kit.ros2cli.graph import Graph
    from course_kit.ros2cli.parser import Run, Verbs

_STARTS_WITHIN = 1.5  # seconds; launch files start a node and `ros2 param set` for it at the same time
_LOOK_EVERY = 0.1


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = _add(verbs, "list", _list, "List the parameters of one node or of all", node=False)
    add_named(listed, "node_name", "nodes", nargs="?", help="such as /robot; if left out, all nodes")
    listed.add_argument("--include-hidden-nodes", action="store_true", help="hidden nodes too")
    listed.add_argument("--param-prefixes", nargs="+", default=[], metavar="PREFIX", help="only those below a prefix")
    listed.add_argument("--param-type", action="store_true", help="with their types")
    listed.add_argument("--filter", metavar="REGEX", help="only those that match")
    get = _add(verbs, "get", _get, "Show the value of a parameter")
    add_named(get, "parameter_name", "parameters")
    get.add_argument("--hide-type", action="store_true", help="the value alone")
    set_ = _add(verbs, "set", _set, "Set a parameter")
    add_named(set_, "parameter_name", "parameters")
    set_.add_argument("value", help="as YAML: 2.5, true, text, [1, 2]")
    describe = _add(verbs, "describe", _describe, "Show type, description and limits of parameters")
    add_named(describe, "parameter_names", "parameters", nargs="+")
    _add(verbs, "dump", _dump, "Show all parameters of a node as a parameter file")
    loaded = _add(verbs, "load", _load, "Set the parameters from a parameter file")
    loaded.add_argument("parameter_file")
    loaded.add_argument("--no-use-wildcard", action="store_true", help="skip what is meant for several nodes")
    delete = _add(verbs, "delete", _delete, "Delete a parameter")
    add_named(delete, "parameter_name", "parameters")


def _add(verbs: Verbs, name: str, run: Run, purpose: str, *, node: bool = True) -> ArgumentParser:
    verb = add_verb(verbs, name, run, purpose)
    if node:
        add_of_kind(verb, "node")
        verb.add_argument("--include-hidden-nodes", action="store_true", help="no effect: a named node is always found")
    add_graph_options(verb)
    return verb


def _client(options: Namespace, session: Session) -> ParameterClient:
    name = checked_name(options.node_name)
    graph = graph_of(options, session)
    ends = time.monotonic() + min(_STARTS_WITHIN, options.timeout)
    while name not in graph.nodes and time.monotonic() < ends:
        time.sleep(_LOOK_EVERY)
        graph = graph_of(options, session)
    return ParameterClient(session, _find_node(name, graph), options.timeout)


def _list(options: Namespace, session: Session) -> None:
    try:
        pattern = re.compile(options.filter or "")
    except re.error as error:
        raise CommandError(f"--filter: {options.filter!r} is not a regular expression: {error}.") from error
    graph = graph_of(options, session)
    if options.node_name:
        nodes = [_find_node(checked_name(options.node_name), graph)]
    else:
        visible = visible_names({node: [] for node in graph.nodes}, hidden_too=options.include_hidden_nodes)
        nodes = [node for node in visible if f"{node}{parameters.LIST_SERVICE}" in graph.services]
    for node in nodes:
        client = ParameterClient(session, node, options.timeout)
        listed = client.ask(parameters.ask_names(options.param_prefixes))
        names = [name for name in sorted(listed) if pattern.search(name)]
        if not options.node_name:
            print(f"{node}:")
        types = (
            [_type_in_words(value) for value in client.ask(parameters.ask_values(names))] if options.param_type else []
        )
        for index, name in enumerate(names):
            print(f"  {name} (type: {types[index]})" if types else f"  {name}")


def _get(options: Namespace, session: Session) -> None:
    value = _client(options, session).require_declared(options.parameter_name)
    if value.type == 0:
        print("None" if options.hide_type else "Parameter not set.")
        return
    label = "" if options.hide_type else f"{_value_in_words(value)} "
    print(f"{label}{parameters.raw_value(value)}")


def _set(options: Namespace, session: Session) -> None:
    message = _parse(options.parameter_name, options.value)
    (result,) = _client(options, session).ask(parameters.set_each([message]))
    _report(result, "Set parameter successful", "Setting parameter failed")


def _delete(options: Namespace, session: Session) -> None:
    client = _client(options, session)
    client.require_declared(options.parameter_name)
    (result,) = client.ask(parameters.set_each([parameters.to_message(options.parameter_name, None)]))
    _report(result, "Deleted parameter successfully", "Deleting parameter failed")


def _report(result: Message, done: str, failed: str) -> None:
    """Refusals go to stderr and are no failure of the command: its exit code stays 0, as recorded."""
    reason = f": {result.reason}" if result.reason else ""
    if result.successful:
        print(f"{done}{reason}")
    else:
        sys.stdout.flush()
        sys.stderr.write(f"{failed}{reason}\n")


def _describe(options: Namespace, session: Session) -> None:
    client = _client(options, session)
    for name in options.parameter_names:
        client.require_declared(name)
    for descriptor in client.ask(parameters.ask_descriptors(options.parameter_names)):
        print(f"Parameter name: {descriptor.name}")
        print(f"  Type: {_type_in_words(descriptor)}")
        if descriptor.description:
            print(f"  Description: {descriptor.description}")
        print("  Constraints:", *_constraints(descriptor), sep="\n    ")


def _constraints(descriptor: Message) -> list[str]:
    found = ["Read only: true"] if descriptor.read_only else []
    for limits in (*descriptor.floating_point_range, *descriptor.integer_range):
        found += [f"Min value: {limits.from_value}", f"Max value: {limits.to_value}"]
        found += [f"Step: {limits.step}"] if limits.step else []
    if descriptor.additional_constraints:
        found.append(f"Additional constraints: {descriptor.additional_constraints}")
    return found


def _dump(options: Namespace, session: Session) -> None:
    import yaml

    client = _client(options, session)
    names = sorted(client.ask(parameters.ask_names()))
    found: dict[str, Any] = {}
    for name, value in zip(names, client.ask(parameters.ask_values(names)), strict=True):
        place, groups = found, name.split(".")
        while len(groups) > 1 and isinstance(place.get(groups[0], {}), dict):  # else a parameter has the group's name
            place = place.setdefault(groups.pop(0), {})
        place[".".join(groups)] = _plain_value(value)
    print(yaml.safe_dump({checked_name(options.node_name): {"ros__parameters": found}}, default_flow_style=False))


def _load(options: Namespace, session: Session) -> None:
    client = _client(options, session)
    node = checked_name(options.node_name)
    loaded = load_parameters(options.parameter_file, node, use_wildcard=not options.no_use_wildcard)
    for parameter, result in zip(loaded, client.ask(parameters.set_each(loaded)), strict=True):
        _report(result, f"Set parameter {parameter.name} successful", f"Set parameter {parameter.name} failed")


def _find_node(name: str, graph: Graph) -> str:
    """The node's full name."""
    if name not in graph.nodes:
        raise CommandError(f"Node not found: {name}.{did_you_mean(name, graph.nodes)}")
    return name


def _type_in_words(value: Message) -> str:
    """The type of a value or a descriptor as the real command calls it."""
    return parameters.type_of(value).replace("bool", "boolean").replace("_", " ")


def _value_in_words(value: Message) -> str:
    """What `param get` prints before a value."""
    kind = _type_in_words(value)
    return f"{kind.removesuffix(' array').capitalize()} {'values are' if 'array' in kind else 'value is'}:"


def _plain_value(value: Message) -> object:
    """What a ParameterValue holds for YAML: arrays as lists, bytes as numbers."""
    found = parameters.from_message(value)
    return [value[0] if isinstance(value, bytes) else value for value in found] if isinstance(found, list) else found


def _parse(name: str, text: str) -> Message:
    """A parameter from what was typed, by ROS 2's rules: YAML decides the type, a mixed list is a string."""
    from rcl_interfaces.msg import Parameter
    from rclpy.parameter import get_parameter_value
    from yaml import YAMLError

    try:
        return Parameter(name=name, value=get_parameter_value(text))
    except (YAMLError, AssertionError, ValueError, OverflowError) as error:
        raise CommandError(f"{text!r} is not a parameter value: {str(error).splitlines()[0]}.") from error

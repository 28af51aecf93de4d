"""`ros2 topic`: list, type, find, info, echo, pub, hz, bw, delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

from course_kit.ros2cli.graph import TopicEndpoints, visible_names
from course_kit.ros2cli.parser import (
    add_graph_options,
    add_named,
    add_node_options,
    add_patience,
    add_timeout,
    add_values,
    add_verbs,
)
from course_kit.ros2cli.text import add_layout
from course_kit.ros2cli.verbs._listing import (
    add_about,
    add_find,
    add_list,
    add_type,
    checked_name,
    graph_of,
    print_names,
    types_of_existing,
)

if TYPE_CHECKING:
    from argparse import ArgumentParser, Namespace

    from course_kit.ros2cli.graph import EndpointFacts, Graph, Names
    from course_kit.ros2cli.parser import Verbs
    from course_kit.ros2cli.session import Session

# Every command's own node brings these two, also where nobody else is.
_ALWAYS = {"/parameter_events": ["rcl_interfaces/msg/ParameterEvent"], "/rosout": ["rcl_interfaces/msg/Log"]}
_HISTORY = ("SYSTEM_DEFAULT", "KEEP_LAST", "KEEP_ALL", "UNKNOWN")
_RELIABILITY = ("SYSTEM_DEFAULT", "RELIABLE", "BEST_EFFORT", "UNKNOWN", "BEST_AVAILABLE")
_DURABILITY = ("SYSTEM_DEFAULT", "TRANSIENT_LOCAL", "VOLATILE", "UNKNOWN", "BEST_AVAILABLE")
_LIVELINESS = ("SYSTEM_DEFAULT", "AUTOMATIC", "UNKNOWN", "MANUAL_BY_TOPIC", "UNKNOWN", "BEST_AVAILABLE")
_NOBODY = TopicEndpoints([], [])
_FOR_EVER = 9223372036854775807  # nanoseconds
_PROFILES = ("system_default", "sensor_data", "services_default", "parameters", "parameter_events", "default")
_POLICIES = {
    "reliability": ("reliable", "best_effort", "system_default"),
    "durability": ("volatile", "transient_local", "system_default"),
    "history": ("keep_last", "keep_all", "system_default"),
}


def add_to(place: ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = add_list(verbs, "topic", _list)
    listed.add_argument("-v", "--verbose", action="store_true", help="who publishes and who subscribes")
    add_graph_options(listed)
    add_type(verbs, "topic", _topics)
    add_find(verbs, "topic", _topics)
    info = add_about(verbs, "topic", "info", _info, "Show the type of a topic and how many are on it")
    info.add_argument("-v", "--verbose", action="store_true", help="nodes and quality of service too")
    add_graph_options(info)
    _add_echo(add_about(verbs, "topic", "echo", _listen, "Show the messages of a topic"))
    _add_pub(add_about(verbs, "topic", "pub", _pub, "Publish messages"))
    hz = _add_measure(verbs, "hz", "Show how often messages come")
    _add_filter(hz, "count")
    hz.add_argument("--wall-time", action="store_true", help="no effect: the time is the computer's anyway")
    _add_measure(verbs, "bw", "Show how many bytes come", window=100)
    _add_measure(verbs, "delay", "Show how old messages are when they come, by their header")


def _add_measure(verbs: Verbs, name: str, purpose: str, window: int = 10000) -> ArgumentParser:
    verb = add_about(verbs, "topic", name, _listen, purpose)
    verb.add_argument("-w", "--window", type=int, default=window, metavar="N", help="count over the last N messages")
    _add_qos(verb)
    add_patience(verb)
    return verb


def _add_filter(verb: ArgumentParser, do: str) -> None:
    what = f"{do} only messages m for which this Python is true"
    verb.add_argument("--filter", dest="filter_expr", metavar="EXPR", help=what)


def _add_qos(verb: ArgumentParser) -> None:
    """The options; see "Quality of Service settings" among the ROS 2 concepts."""
    group = verb.add_argument_group("quality of service")
    group.add_argument("--qos-profile", choices=_PROFILES, metavar="PROFILE", help=", ".join(_PROFILES))
    group.add_argument("--qos-depth", type=int, metavar="N", help="messages kept")
    for policy, values in _POLICIES.items():
        group.add_argument(f"--qos-{policy}", choices=values, metavar=policy.upper(), help=", ".join(values))


def _add_echo(verb: ArgumentParser) -> None:
    add_named(verb, "message_type", "message_types", nargs="?", help="found automatically if left out")
    verb.add_argument("--once", action="store_true", help="only the first message")
    verb.add_argument("--field", metavar="NAME", help="only this field, such as pose.position")
    add_layout(verb)
    verb.add_argument("-i", "--include-message-info", action="store_true", help="also each message's times")
    verb.add_argument("--raw", action="store_true", help="the bytes, undecoded")
    verb.add_argument("--no-lost-messages", action="store_true", help="no effect: lost messages are not reported")
    _add_filter(verb, "show")
    _add_qos(verb)
    add_patience(verb)


def _add_pub(verb: ArgumentParser) -> None:
    add_named(verb, "message_type", "message_types", help="such as std_msgs/msg/String")
    add_values(verb, "values", "the message's fields as YAML, such as '{data: hello}'")
    verb.add_argument("-r", "--rate", type=float, default=1.0, metavar="N", help="messages a second (default: 1)")
    often = verb.add_mutually_exclusive_group()
    often.add_argument("-1", "--once", action="store_true", help="one message")
    often.add_argument("-t", "--times", type=int, default=0, metavar="N", help="publish N messages, then end")
    verb.add_argument("-p", "--print", type=int, default=1, metavar="N", dest="print_every", help="show every Nth")
    verb.add_argument("-w", "--wait-matching-subscriptions", type=int, metavar="N", help="wait for N subscriptions")
    verb.add_argument(
        "--max-wait-time-secs", dest="max_wait", type=float, metavar="N", help="wait for them N seconds at most"
    )
    verb.add_argument("-n", "--node-name", metavar="NAME", help="the name of the publishing node")
    verb.add_argument("--keep-alive", type=float, metavar="N", help="no effect: it always waits for the delivery")
    _add_qos(verb)
    add_timeout(verb, "seconds to wait for subscriptions, and for the delivery, at most")
    add_node_options(verb)


def _list(options: Namespace, session: Session) -> None:
    graph = graph_of(options, session)
    topics = visible_names(_topics(graph), hidden_too=options.hidden)
    if not options.verbose:
        print_names(topics, options)
        return
    for title, which, word in (("Published", 0, "publisher"), ("Subscribed", 1, "subscriber")):
        print(f"{title} topics:")
        for topic, types in topics.items():
            if many := len(graph.endpoints.get(topic, _NOBODY)[which]):
                print(f" * {topic} [{', '.join(types)}] {many} {word}{'s' if many > 1 else ''}")
        print()


def _info(options: Namespace, session: Session) -> None:
    name = checked_name(options.topic_name)
    graph = graph_of(options, session)
    types = types_of_existing("topic", name, _topics(graph))
    publishers, subscriptions = graph.endpoints.get(name, _NOBODY)
    print(f"Type: {types[0] if len(types) == 1 else types}", end="\n\n" if options.verbose else "\n")
    for title, endpoints in (("Publisher", publishers), ("Subscription", subscriptions)):
        print(f"{title} count: {len(endpoints)}", end="\n\n" if options.verbose else "\n")
        for endpoint in endpoints if options.verbose else []:
            _print_endpoint(endpoint, title.upper())


def _print_endpoint(info: EndpointFacts, kind: str) -> None:
    qos = info["qos_profile"]
    history = _HISTORY[qos["history"]]
    depth = f" ({qos['depth']})" if history == "KEEP_LAST" else ""
    print(
        f"Node name: {info['node_name']}",
        f"Node namespace: {info['node_namespace']}",
        f"Topic type: {info['topic_type']}",
        f"Topic type hash: {info['topic_type_hash']}",
        f"Endpoint type: {kind}",
        f"GID: {'.'.join(f'{byte:02x}' for byte in info['endpoint_gid'])}",
        "QoS profile:",
        f"  Reliability: {_RELIABILITY[qos['reliability']]}",
        f"  History (Depth): {history}{depth}",
        f"  Durability: {_DURABILITY[qos['durability']]}",
        f"  Lifespan: {_duration(qos['lifespan'])}",
        f"  Deadline: {_duration(qos['deadline'])}",
        f"  Liveliness: {_LIVELINESS[qos['liveliness']]}",
        f"  Liveliness lease duration: {_duration(qos['liveliness_lease_duration'])}",
        sep="\n",
        end="\n\n",
    )


def _duration(nanoseconds: int) -> str:
    return "Infinite" if nanoseconds == _FOR_EVER else f"{nanoseconds} nanoseconds"


def _topics(graph: Graph) -> Names:
    return {**_ALWAYS, **graph.topics}


def _listen(options: Namespace, session: Session) -> None:
    """What `echo`, `hz`, `delay` and `bw` do, each by its function."""
    from course_kit.ros2cli import listening

    listening.VERBS[options.verb](listening.Listener(options, session, checked_name(options.topic_name)))


def _pub(options: Namespace, session: Session) -> None:
    from course_kit.ros2cli.listening import publish_values

    publish_values(options, session, checked_name(options.topic_name))

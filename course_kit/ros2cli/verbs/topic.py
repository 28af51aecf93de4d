"""`ros2 topic`: list, type, info, echo, pub, hz."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from course_kit.ros.names import did_you_mean
from course_kit.ros2cli.errors import CommandError
from course_kit.ros2cli.graph import Graph, visible
from course_kit.ros2cli.parser import add_graph_options, add_named, add_timeout, add_verb, add_verbs
from course_kit.ros2cli.qos import add_qos
from course_kit.ros2cli.text import TRUNCATE
from course_kit.ros2cli.verbs._listing import checked_name, graph_of, print_names

if TYPE_CHECKING:
    import argparse

    from course_kit.ros2cli.session import Session

# Every command's own node brings these two, also where nobody else is.
_ALWAYS = {"/parameter_events": ["rcl_interfaces/msg/ParameterEvent"], "/rosout": ["rcl_interfaces/msg/Log"]}
_HISTORY = ("SYSTEM_DEFAULT", "KEEP_LAST", "KEEP_ALL", "UNKNOWN")
_RELIABILITY = ("SYSTEM_DEFAULT", "RELIABLE", "BEST_EFFORT", "UNKNOWN", "BEST_AVAILABLE")
_DURABILITY = ("SYSTEM_DEFAULT", "TRANSIENT_LOCAL", "VOLATILE", "UNKNOWN", "BEST_AVAILABLE")
_LIVELINESS = ("SYSTEM_DEFAULT", "AUTOMATIC", "UNKNOWN", "MANUAL_BY_TOPIC", "UNKNOWN", "BEST_AVAILABLE")
_FOR_EVER = 9223372036854775807  # nanoseconds


def add_to(place: argparse.ArgumentParser) -> None:
    """Add the verbs."""
    verbs = add_verbs(place)
    listed = add_verb(verbs, "list", _list, "List the topics on the graph")
    listed.add_argument("-t", "--show-types", action="store_true", help="with their types")
    listed.add_argument("-c", "--count-topics", action="store_true", help="only how many there are")
    listed.add_argument("-a", "--include-hidden-topics", action="store_true", help="hidden ones too, as of actions")
    listed.add_argument("-v", "--verbose", action="store_true", help="who publishes and who subscribes")
    add_graph_options(listed)
    kind = add_verb(verbs, "type", _type, "Show the type of a topic")
    add_named(kind, "topic_name", "topics", help="such as /chatter")
    add_graph_options(kind)
    info = add_verb(verbs, "info", _info, "Show the type of a topic and how many are on it")
    add_named(info, "topic_name", "topics", help="such as /chatter")
    info.add_argument("-v", "--verbose", action="store_true", help="nodes and quality of service too")
    add_graph_options(info)
    _add_echo(add_verb(verbs, "echo", _echo, "Show the messages of a topic"))
    _add_pub(add_verb(verbs, "pub", _pub, "Publish messages"))
    hz = add_verb(verbs, "hz", _hz, "Show how often messages come")
    add_named(hz, "topic_name", "topics", help="such as /chatter")
    hz.add_argument("-w", "--window", type=int, default=10000, metavar="N", help="messages looked at")
    add_qos(hz)
    add_timeout(hz, "seconds without a message after which it ends")


def _add_echo(verb: argparse.ArgumentParser) -> None:
    add_named(verb, "topic_name", "topics", help="such as /chatter")
    add_named(verb, "message_type", "message_types", nargs="?", help="found out when left out")
    verb.add_argument("--once", action="store_true", help="only the first message")
    verb.add_argument("--field", metavar="NAME", help="only this field, such as pose.position")
    verb.add_argument("-f", "--full-length", action="store_true", help="long strings and arrays in full")
    verb.add_argument("-l", "--truncate-length", type=int, default=TRUNCATE, metavar="N", help="where they are cut")
    verb.add_argument("--no-arr", action="store_true", help="no elements of arrays")
    verb.add_argument("--no-str", action="store_true", help="no strings")
    verb.add_argument("--flow-style", action="store_true", help="in one line")
    verb.add_argument("--csv", action="store_true", help="values separated by commas")
    add_qos(verb)
    add_timeout(verb, "seconds without a message after which it ends")


def _add_pub(verb: argparse.ArgumentParser) -> None:
    add_named(verb, "topic_name", "topics", help="such as /chatter")
    add_named(verb, "message_type", "message_types", help="such as std_msgs/msg/String")
    verb.add_argument("values", nargs="?", help="the message's fields as YAML, such as '{data: hello}'")
    often = verb.add_mutually_exclusive_group()
    often.add_argument("-r", "--rate", type=float, default=1.0, metavar="N", help="messages a second (default: 1)")
    often.add_argument("-1", "--once", action="store_true", help="one message")
    often.add_argument("-t", "--times", type=int, default=0, metavar="N", help="N messages, then the end")
    verb.add_argument("-p", "--print", type=int, default=1, metavar="N", dest="print_every", help="show every Nth")
    verb.add_argument("-w", "--wait-matching-subscriptions", type=int, metavar="N", help="wait for N subscriptions")
    verb.add_argument("--keep-alive", type=float, metavar="N", help="accepted; the end waits for the delivery anyway")
    add_qos(verb)
    add_timeout(verb, "seconds to wait for subscriptions, and for the delivery, at most")


def _list(options: Any, session: Session) -> None:
    graph = graph_of(options, session)
    topics = visible({**_ALWAYS, **graph.topics}, hidden_too=options.include_hidden_topics)
    if not options.verbose:
        print_names(topics, types=options.show_types, count=options.count_topics)
        return
    for title, which, word in (("Published", 0, "publisher"), ("Subscribed", 1, "subscriber")):
        print(f"{title} topics:")
        for topic, types in topics.items():
            if many := len(_endpoints(graph, topic)[which]):
                print(f" * {topic} [{', '.join(types)}] {many} {word}{'s' if many > 1 else ''}")
        print()


def _type(options: Any, session: Session) -> None:
    for topic_type in _existing(checked_name(options.topic_name), graph_of(options, session)):
        print(topic_type)


def _info(options: Any, session: Session) -> None:
    name = checked_name(options.topic_name)
    graph = graph_of(options, session)
    types = _existing(name, graph)
    publishers, subscriptions = _endpoints(graph, name)
    print(f"Type: {types[0] if len(types) == 1 else types}", end="\n\n" if options.verbose else "\n")
    for title, endpoints in (("Publisher", publishers), ("Subscription", subscriptions)):
        print(f"{title} count: {len(endpoints)}", end="\n\n" if options.verbose else "\n")
        for endpoint in endpoints if options.verbose else []:
            _print_endpoint(endpoint, title.upper())


def _print_endpoint(info: dict[str, Any], kind: str) -> None:
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


def _endpoints(graph: Graph, topic: str) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    publishers, subscriptions = graph.endpoints.get(topic, ([], []))
    return publishers, subscriptions


def _existing(name: str, graph: Graph) -> list[str]:
    topics = {**_ALWAYS, **graph.topics}
    if name not in topics:
        raise CommandError(f"Unknown topic '{name}'.{did_you_mean(name, topics)}")
    return topics[name]


def _echo(options: Any, session: Session) -> None:
    from course_kit.ros2cli.messages import Listener
    from course_kit.ros2cli.text import Layout

    layout = Layout(
        truncate=None if options.full_length else options.truncate_length,
        arrays=not options.no_arr,
        strings=not options.no_str,
        flow=options.flow_style,
    )
    Listener(options, session, checked_name(options.topic_name)).echo(layout)


def _hz(options: Any, session: Session) -> None:
    from course_kit.ros2cli.messages import Listener

    Listener(options, session, checked_name(options.topic_name)).rate(options.window)


def _pub(options: Any, session: Session) -> None:
    from course_kit.ros2cli.messages import publish

    publish(options, session, checked_name(options.topic_name))

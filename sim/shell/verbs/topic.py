"""``ros2 topic``: the list of its verbs, and those that only read the graph."""

from __future__ import annotations

from argparse import Namespace

from sim.shell.graph import NamesAndTypes, full_topic_name, known_topics, shown, topic_types, without_hidden
from sim.shell.parser import LineParser
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.interface import known_messages
from sim.shell.verbs.topic_echo import ECHO
from sim.shell.verbs.topic_pub import PUB
from sim.shell.verbs.topic_statistics import BW, DELAY, HZ
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options

_UNKNOWN = "Unknown topic '{}'"


def _add_topic(parser: LineParser) -> None:
    parser.argument("topic_name", help="Name of the ROS topic (e.g. '/chatter')", completer=known_topics)
    add_graph_options(parser)


def _add_hidden(parser: LineParser) -> None:
    parser.flag("--include-hidden-topics", help="Consider hidden topics as well")


def _add_list(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.flag("-t", "--show-types", help="Additionally show the topic type")
    parser.flag("-c", "--count-topics", help="Only display the number of topics discovered")
    _add_hidden(parser)
    parser.flag("-v", "--verbose", help="List full details about each topic")


def _list(session: ShellSession, arguments: Namespace) -> None:
    topics = without_hidden(session.node.get_topic_names_and_types(), arguments.include_hidden_topics)
    if arguments.count_topics:
        session.say(str(len(topics)))
    elif arguments.verbose and topics:
        publishers = {name: session.node.count_publishers(name) for name, _ in topics}
        subscribers = {name: session.node.count_subscribers(name) for name, _ in topics}
        session.say(_details("Published", "publisher", topics, publishers))
        session.say(_details("Subscribed", "subscriber", topics, subscribers))
    else:
        session.say_each(shown(topics, arguments.show_types))


def _details(what: str, who: str, topics: NamesAndTypes, counts: dict[str, int]) -> str:
    lines = [
        f" * {name} [{', '.join(types)}] {counts[name]} {who}{'s' if counts[name] > 1 else ''}\n"
        for name, types in topics
        if counts[name]
    ]
    return f"{what} topics:\n{''.join(lines)}"


def _add_info(parser: LineParser) -> None:
    _add_topic(parser)
    parser.flag(
        "-v",
        "--verbose",
        help="Prints detailed information like the node name, node namespace, topic type, topic type hash, "
        "GUID and QoS Profile of the publishers and subscribers to this topic",
    )


def _info(session: ShellSession, arguments: Namespace) -> None:
    node, topic = session.node, arguments.topic_name
    full, types = full_topic_name(session, topic), topic_types(session, topic)
    if types is None:
        raise CommandFailed(_UNKNOWN.format(topic))
    end = "\n" if arguments.verbose else ""
    session.say(f"Type: {types[0] if len(types) == 1 else types}{end}")
    session.say(f"Publisher count: {node.count_publishers(full)}{end}")
    if arguments.verbose:
        session.say_each(f"{each}\n" for each in node.get_publishers_info_by_topic(full))
    session.say(f"Subscription count: {node.count_subscribers(full)}{end}")
    if arguments.verbose:
        session.say_each(f"{each}\n" for each in node.get_subscriptions_info_by_topic(full))


def _type(session: ShellSession, arguments: Namespace) -> None:
    types = topic_types(session, arguments.topic_name)
    if types is None:
        raise CommandFailed(_UNKNOWN.format(arguments.topic_name))
    session.say_each(types)


def _add_find(parser: LineParser) -> None:
    parser.argument(
        "topic_type",
        help="Name of the ROS topic type to filter for (e.g. 'std_msgs/msg/String')",
        completer=known_messages,
    )
    add_graph_options(parser)
    parser.flag("-c", "--count-topics", help="Only display the number of topics discovered")
    _add_hidden(parser)


def _find(session: ShellSession, arguments: Namespace) -> None:
    topics = without_hidden(session.node.get_topic_names_and_types(), arguments.include_hidden_topics)
    found = [name for name, types in topics if arguments.topic_type in types]
    session.say_each(found, arguments.count_topics)


TOPIC = ShellCommand(
    "topic",
    "Various topic related sub-commands",
    (
        BW,
        DELAY,
        ECHO,
        Verb("find", "Output a list of available topics of a given type", _add_find, _find),
        HZ,
        Verb("info", "Print information about a topic", _add_info, _info),
        Verb("list", "Output a list of available topics", _add_list, _list),
        PUB,
        Verb("type", "Print a topic's type", _add_topic, _type),
    ),
)

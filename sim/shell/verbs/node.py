"""``ros2 node``: lists nodes and their topics, services and actions."""

from __future__ import annotations

from argparse import Namespace
from collections import Counter

from sim.ros.actions.graph import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from sim.shell.graph import absolute, is_hidden, known_nodes, without_hidden
from sim.shell.parser import LineParser
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options


def _add_list(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.flag("-a", "--all", help="Display all nodes even hidden ones")
    parser.flag("-c", "--count-nodes", help="Only display the number of nodes discovered")


def _list(session: ShellSession, arguments: Namespace) -> None:
    every = sorted(session.node.get_fully_qualified_node_names())
    names = [name for name in every if arguments.all or not is_hidden(name)]
    if not arguments.count_nodes and any(count > 1 for count in Counter(names).values()):
        session.complain(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, "
            "which can have unintended side effects."
        )
    session.say_each(names, arguments.count_nodes)


def _add_info(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.argument("node_name", help="Node name to request information", completer=known_nodes)
    parser.flag("--include-hidden", help="Display hidden topics, services, and actions as well")


def _info(session: ShellSession, arguments: Namespace) -> None:
    node, full = session.node, absolute(arguments.node_name)
    count = node.get_fully_qualified_node_names().count(full)
    if count == 0:
        raise CommandFailed(f"Unable to find node '{arguments.node_name}'")
    if count > 1:
        session.say(
            f'There are {count} nodes in the graph with the exact name "{arguments.node_name}". '
            "You are seeing information about only one of them."
        )
    namespace, _, name = full.rpartition("/")
    own = (name, namespace or "/")
    session.say(arguments.node_name)
    hidden = arguments.include_hidden
    for title, found in (
        ("Subscribers", without_hidden(node.get_subscriber_names_and_types_by_node(*own), hidden)),
        ("Publishers", without_hidden(node.get_publisher_names_and_types_by_node(*own), hidden)),
        ("Service Servers", without_hidden(node.get_service_names_and_types_by_node(*own), hidden)),
        ("Service Clients", without_hidden(node.get_client_names_and_types_by_node(*own), hidden)),
        ("Action Servers", get_action_server_names_and_types_by_node(node, *own)),
        ("Action Clients", get_action_client_names_and_types_by_node(node, *own)),
    ):
        session.say(f"  {title}:")
        session.say("\n".join(f"    {each}: {', '.join(types)}" for each, types in found))


NODE = ShellCommand(
    "node",
    "Various node related sub-commands",
    (
        Verb("info", "Output information about a node", _add_info, _info),
        Verb("list", "Output a list of available nodes", _add_list, _list),
    ),
)

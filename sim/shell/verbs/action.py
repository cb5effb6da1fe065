"""``ros2 action``: lists actions and sends goals."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from typing import Any

from sim.interfaces.rosidl_runtime_py import message_to_yaml
from sim.ros.actions import ActionClient
from sim.ros.actions.graph import (
    get_action_client_names_and_types_by_node,
    get_action_names_and_types,
    get_action_server_names_and_types_by_node,
)
from sim.ros.node.node import Node
from sim.shell.graph import NamesAndTypes, known_topics, shown, type_of_given
from sim.shell.messages import NO_DICTIONARY, Outgoing, action_class, given_values, prototype_word
from sim.shell.parser import LineParser, Surroundings
from sim.shell.session import CommandFailed, CommandInterrupted, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options

_FEEDBACK, _FEEDBACK_TYPE = "/_action/feedback", "_FeedbackMessage"


_STATUS_WORDS = ("UNKNOWN", "ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
"""By the numbers of ``action_msgs/msg/GoalStatus``."""


def _known_actions(surroundings: Surroundings) -> dict[str, list[str]]:
    return {
        name.removesuffix(_FEEDBACK): [each.removesuffix(_FEEDBACK_TYPE) for each in types]
        for name, types in known_topics(surroundings).items()
        if name.endswith(_FEEDBACK)
    }


def _goal_prototype(surroundings: Surroundings) -> list[str]:
    return [prototype_word(action_class(surroundings.ground, surroundings.given[1]).Goal)]


# list, type, info


def _add_list(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.flag("-t", "--show-types", help="Additionally show the action type")
    parser.flag("-c", "--count-actions", help="Only display the number of actions discovered")


def _list(session: ShellSession, arguments: Namespace) -> None:
    actions = get_action_names_and_types(session.node)
    session.say_each(shown(actions, arguments.show_types), arguments.count_actions)


def _add_action(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.argument(
        "action_name", help="Name of the ROS action to get info (e.g. '/fibonacci')", completer=_known_actions
    )


def _type(session: ShellSession, arguments: Namespace) -> None:
    types = dict(get_action_names_and_types(session.node)).get(_full(session, arguments.action_name))
    if types is None:
        raise CommandFailed(f"Unknown action '{arguments.action_name}'")
    session.say_each(types)


def _full(session: ShellSession, name: str) -> str:
    return session.node.resolve_topic_name(name)


def _add_info(parser: LineParser) -> None:
    _add_action(parser)
    parser.flag("-t", "--show-types", help="Additionally show the action type")
    parser.flag("-c", "--count", help="Only display the number of action clients and action servers")


def _info(session: ShellSession, arguments: Namespace) -> None:
    session.say(f"Action: {arguments.action_name}")
    full = _full(session, arguments.action_name)
    for title, ask in (
        ("Action clients", get_action_client_names_and_types_by_node),
        ("Action servers", get_action_server_names_and_types_by_node),
    ):
        found = _nodes_with(session.node, full, ask)
        session.say(f"{title}: {len(found)}")
        if not arguments.count:
            session.say_each(f"    {line}" for line in shown(found, arguments.show_types))


def _nodes_with(node: Node, action: str, ask: Callable[[Node, str, str], NamesAndTypes]) -> NamesAndTypes:
    """Return the nodes with a client or server of an action, and its types."""
    found = []
    for name, namespace in node.get_node_names_and_namespaces():
        types = dict(ask(node, name, namespace)).get(action)
        if types is not None:
            found.append((f"{namespace.rstrip('/')}/{name}", types))
    return found


# send_goal


def _add_send_goal(parser: LineParser) -> None:
    parser.argument(
        "action_name", help="Name of the ROS action (e.g. '/fibonacci')", completer=_known_actions
    )
    parser.argument(
        "action_type",
        help="Type of the ROS action (e.g. 'example_interfaces/action/Fibonacci')",
        completer=type_of_given(_known_actions, "action"),
    )
    parser.argument(
        "goal", help="Goal request values in YAML format (e.g. '{order: 10}')", completer=_goal_prototype
    )
    parser.flag("-f", "--feedback", help="Echo feedback messages for the goal")


def _send_goal(session: ShellSession, arguments: Namespace) -> None:
    action_type = action_class(session.ground, arguments.action_type)
    values = given_values(arguments.goal)
    if not isinstance(values, dict):
        raise CommandFailed(NO_DICTIONARY)
    outgoing = Outgoing(action_type.Goal, values)
    client = ActionClient(session.node, action_type, arguments.action_name)
    session.say("Waiting for an action server to become available...")
    session.wait_until(client.server_is_ready)
    outgoing.stamp(session.node.get_clock().now().to_msg())
    session.say(f"Sending goal:\n     {message_to_yaml(outgoing.message)}")

    def show_feedback(feedback: Any) -> None:
        session.say(f"Feedback:\n    {message_to_yaml(feedback.feedback)}")

    sent = client.send_goal_async(outgoing.message, show_feedback if arguments.feedback else None)
    session.spin(sent)
    goal_handle: Any = sent.result()
    if not goal_handle.accepted:
        session.say("Goal was rejected.")
        return
    session.say(f"Goal accepted with ID: {bytes(goal_handle.goal_id.uuid).hex()}\n")
    _await_result(session, goal_handle)


def _await_result(session: ShellSession, goal_handle: Any) -> None:
    asked = goal_handle.get_result_async()
    try:
        session.spin(asked)
    except CommandInterrupted:
        _cancel(session, goal_handle)
        raise
    response = asked.result()
    session.say(f"Result:\n    {message_to_yaml(response.result)}")
    session.say(f"Goal finished with status: {_STATUS_WORDS[response.status]}")


def _cancel(session: ShellSession, goal_handle: Any) -> None:
    """Cancel the goal, as ros2 does after Ctrl-C, without waiting for the answer."""
    session.say("Canceling goal...")
    goal_handle.cancel_goal_async()


ACTION = ShellCommand(
    "action",
    "Various action related sub-commands",
    (
        Verb("info", "Print information about an action", _add_info, _info),
        Verb("list", "Output a list of action names", _add_list, _list),
        Verb("send_goal", "Send an action goal", _add_send_goal, _send_goal),
        Verb("type", "Print a action's type", _add_action, _type),
    ),
)

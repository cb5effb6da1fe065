"""``ros2 lifecycle``: the states and transitions of managed nodes."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from sim.shell.graph import absolute, is_hidden, known_nodes
from sim.shell.parser import LineParser, Surroundings
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options, add_hidden_nodes_option

_STATE = "lifecycle_msgs/srv/GetState"
_NOT_FOUND = "Node not found"


def _managed(session: ShellSession) -> list[str]:
    """The full names of all nodes that have a lifecycle."""
    return sorted(
        name.removesuffix("/get_state")
        for name, types in session.node.get_service_names_and_types()
        if name.endswith("/get_state") and _STATE in types
    )


def _add_nodes(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.flag("-a", "--all", help="Display all nodes even hidden ones")
    parser.flag("-c", "--count-nodes", help="Only display the number of nodes")


def _nodes(session: ShellSession, arguments: Namespace) -> None:
    names = [name for name in _managed(session) if arguments.all or not is_hidden(name)]
    session.say_each(names, arguments.count_nodes)


def _add_hidden(parser: LineParser) -> None:
    add_graph_options(parser)
    add_hidden_nodes_option(parser)


def _add_get(parser: LineParser) -> None:
    _add_hidden(parser)
    parser.argument("node_name", nargs="?", help="Name of the ROS node to query", completer=known_nodes)
    parser.flag("--transitions", help="Output possible transitions")


def _get(session: ShellSession, arguments: Namespace) -> None:
    if arguments.node_name is not None:
        node = _chosen(session, arguments)
        session.say(_described(_state(session, node)))
        if arguments.transitions:
            _say_transitions(session, node, "get_available_transitions")
        return
    for name in _managed(session):
        if arguments.include_hidden_nodes or not is_hidden(name):
            session.say(f"{name}: {_described(_state(session, name))}")


def _add_list(parser: LineParser) -> None:
    _add_hidden(parser)
    parser.argument("node_name", help="Name of the ROS node to query", completer=known_nodes)
    parser.flag("-a", "--all", help="Display all existing transitions, not only available ones")


def _list(session: ShellSession, arguments: Namespace) -> None:
    kind = "get_transition_graph" if arguments.all else "get_available_transitions"
    _say_transitions(session, _chosen(session, arguments), kind)


def _say_transitions(session: ShellSession, node: str, kind: str) -> None:
    found = _call(session, node, kind, "GetAvailableTransitions")
    for each in found.available_transitions:
        session.say(
            f"- {each.transition.label} [{each.transition.id}]\n"
            f"\tStart: {each.start_state.label}\n\tGoal: {each.goal_state.label}"
        )


def _transitions(_surroundings: Surroundings) -> list[str]:
    return ["activate", "cleanup", "configure", "deactivate", "shutdown"]


def _add_set(parser: LineParser) -> None:
    _add_hidden(parser)
    parser.argument("node_name", help="Name of the ROS node", completer=known_nodes)
    parser.argument("transition", help="The lifecycle transition", completer=_transitions)


def _set(session: ShellSession, arguments: Namespace) -> None:
    node = _chosen(session, arguments)
    found = _call(session, node, "get_available_transitions", "GetAvailableTransitions")
    known = {each.transition.label: each.transition for each in found.available_transitions}
    by_number = {str(each.id): each for each in known.values()}
    chosen = known.get(arguments.transition) or by_number.get(arguments.transition)
    if chosen is None:
        lines = "".join(f"\n- {each.label} [{each.id}]" for each in known.values())
        raise CommandFailed(f"Unknown transition requested, available ones are:{lines}")
    answer = _call(session, node, "change_state", "ChangeState", transition=chosen)
    if not answer.success:
        raise CommandFailed("Transitioning failed")
    session.say("Transitioning successful")


def _chosen(session: ShellSession, arguments: Namespace) -> str:
    name = absolute(arguments.node_name)
    if name not in _managed(session) or (is_hidden(name) and not arguments.include_hidden_nodes):
        raise CommandFailed(_NOT_FOUND)
    return name


def _state(session: ShellSession, node: str) -> Any:
    return _call(session, node, "get_state", "GetState").current_state


def _described(state: Any) -> str:
    return f"{state.label} [{state.id}]"


def _call(session: ShellSession, node: str, name: str, srv_name: str, **request: Any) -> Any:
    srv_type: Any = session.ground.interface("srv", "lifecycle_msgs", srv_name)
    future = session.node.create_client(srv_type, f"{node}/{name}").call_async(srv_type.Request(**request))
    session.spin(future)
    if (error := future.exception()) is not None:
        raise CommandFailed(f"Exception while calling service of node '{node}': {error}")
    return future.result()


LIFECYCLE = ShellCommand(
    "lifecycle",
    "Various lifecycle related sub-commands",
    (
        Verb("get", "Get lifecycle state for one or more nodes", _add_get, _get),
        Verb("list", "Output a list of available transitions", _add_list, _list),
        Verb("nodes", "Output a list of nodes with lifecycle", _add_nodes, _nodes),
        Verb("set", "Trigger lifecycle state transition", _add_set, _set),
    ),
)

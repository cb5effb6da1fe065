"""Queries of the actions on the graph; an action is identified by its feedback topic."""

from sim.ros.node.graph import NamesAndTypes
from sim.ros.node.node import Node

_TOPIC = "/_action/feedback"
_TYPE = "_FeedbackMessage"


def get_action_client_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """The actions of which a node has clients; NodeNameNonExistentError without that node."""
    return _actions(node.get_subscriber_names_and_types_by_node(remote_node_name, remote_node_namespace))


def get_action_server_names_and_types_by_node(
    node: Node, remote_node_name: str, remote_node_namespace: str
) -> NamesAndTypes:
    """The actions that a node serves; NodeNameNonExistentError without that node."""
    return _actions(node.get_publisher_names_and_types_by_node(remote_node_name, remote_node_namespace))


def get_action_names_and_types(node: Node) -> NamesAndTypes:
    """All actions with their types."""
    return _actions(node.get_topic_names_and_types())


def _actions(topics: NamesAndTypes) -> NamesAndTypes:
    return [
        (name.removesuffix(_TOPIC), [each.removesuffix(_TYPE) for each in types if each.endswith(_TYPE)])
        for name, types in topics
        if name.endswith(_TOPIC) and any(each.endswith(_TYPE) for each in types)
    ]

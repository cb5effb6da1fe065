"""Expands the name of a topic or service to its full name, as rclpy's function."""

from sim.ros.naming.names import full_name
from sim.ros.naming.rules import namespace_problem, node_name_problem, topic_name_problem


def expand_topic_name(topic_name: str, node_name: str, node_namespace: str) -> str:
    """The full name of a topic or service for a node of that name and namespace.

    Raises:
        ValueError: a name breaks the rules, or a substitution is unknown.
    """
    for found, what in (
        (topic_name_problem(topic_name), "topic name is invalid"),
        (node_name_problem(node_name), "node name is invalid"),
        (namespace_problem(node_namespace), "node namespace is invalid"),
    ):
        if found is not None:
            raise ValueError(f"{what}: {found.text}")
    return full_name(topic_name, node_name, node_namespace)

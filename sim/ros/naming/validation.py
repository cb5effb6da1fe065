"""Checks of names. Each returns True, or raises an error with the first broken rule and its place."""

from typing import Literal

from sim.ros.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidParameterException,
    InvalidServiceNameException,
    InvalidTopicNameException,
)
from sim.ros.naming.rules import (
    full_topic_name_problem,
    namespace_problem,
    node_name_problem,
    topic_name_problem,
)


def validate_node_name(node_name: str) -> Literal[True]:
    """Check the name of a node without its namespace; InvalidNodeNameException if a rule is broken."""
    if (problem := node_name_problem(node_name)) is not None:
        raise InvalidNodeNameException(node_name, *problem)
    return True


def validate_namespace(namespace: str) -> Literal[True]:
    """Check an absolute namespace; InvalidNamespaceException if a rule is broken."""
    if (problem := namespace_problem(namespace)) is not None:
        raise InvalidNamespaceException(namespace, *problem)
    return True


def validate_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """Check a name that can be expanded, such as ``~/x``, ``{node}/x``, ``x`` and ``/x``.

    Raises:
        InvalidTopicNameException, InvalidServiceNameException: a rule is broken.
    """
    if (problem := topic_name_problem(name)) is not None:
        raise _error_for(is_service)(name, *problem)
    return True


def validate_full_topic_name(name: str, *, is_service: bool = False) -> Literal[True]:
    """Check an absolute name that has nothing left to expand; raises as ``validate_topic_name``."""
    if (problem := full_topic_name_problem(name)) is not None:
        raise _error_for(is_service)(name, *problem)
    return True


def validate_parameter_name(name: str) -> bool:
    """Check that a parameter's name is not empty; InvalidParameterException if it is."""
    if not name:
        raise InvalidParameterException(name)
    return True


def _error_for(is_service: bool) -> type[InvalidServiceNameException] | type[InvalidTopicNameException]:
    return InvalidServiceNameException if is_service else InvalidTopicNameException

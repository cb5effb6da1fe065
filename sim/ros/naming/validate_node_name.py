"""Checking the name of a node."""

from typing import Literal

from sim.ros.exceptions import InvalidNodeNameException
from sim.ros.naming.rules import node_name_problem


def validate_node_name(node_name: str) -> Literal[True]:
    """True for a node's name without namespace.

    Raises:
        InvalidNodeNameException: the name breaks the rules.
    """
    if (problem := node_name_problem(node_name)) is not None:
        raise InvalidNodeNameException(node_name, *problem)
    return True

"""Checking the namespace of a node."""

from typing import Literal

from sim.ros.exceptions import InvalidNamespaceException
from sim.ros.naming.rules import namespace_problem


def validate_namespace(namespace: str) -> Literal[True]:
    """True for an absolute, well-formed namespace.

    Raises:
        InvalidNamespaceException: it breaks the rules.
    """
    if (problem := namespace_problem(namespace)) is not None:
        raise InvalidNamespaceException(namespace, *problem)
    return True

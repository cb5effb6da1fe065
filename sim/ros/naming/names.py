"""Names of nodes, topics and services: how short ones become full, and which are refused.

The rules themselves are in ``sim.ros.naming.rules``.
"""

import re

from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.rules import full_topic_name_problem, topic_name_problem

_SUBSTITUTION = re.compile(r"\{([^{}]*)\}")
_NameError = type[InvalidTopicNameException] | type[InvalidServiceNameException]


class UnknownSubstitutionError(ValueError):
    """A name in curly braces stands for nothing."""

    def __init__(self, name: str) -> None:
        super().__init__(f"unknown substitution '{{{name}}}'")


def expand_topic(name: str, node_name: str, namespace: str) -> str:
    """The full name of a topic as a node means it.

    Raises:
        InvalidTopicNameException: the name breaks the rules.
        UnknownSubstitutionError: it has one.
    """
    return _expand(name, node_name, namespace, InvalidTopicNameException)


def expand_service(name: str, node_name: str, namespace: str) -> str:
    """The full name of a service as a node means it.

    Raises:
        InvalidServiceNameException: the name breaks the rules.
        UnknownSubstitutionError: it has one.
    """
    return _expand(name, node_name, namespace, InvalidServiceNameException)


def full_name(name: str, node_name: str, namespace: str) -> str:
    """The full name that a well-formed name stands for.

    Raises:
        UnknownSubstitutionError: it has one.
    """
    known = {"node": node_name, "ns": namespace, "namespace": namespace}

    def value(match: re.Match[str]) -> str:
        if match[1] not in known:
            raise UnknownSubstitutionError(match[1])
        return known[match[1]]

    substituted = _SUBSTITUTION.sub(value, name)
    base = "" if namespace == "/" else namespace
    if substituted.startswith("~"):
        return f"{base}/{node_name}{substituted[1:]}"
    return substituted if substituted.startswith("/") else f"{base}/{substituted}"


def _expand(name: str, node_name: str, namespace: str, error: _NameError) -> str:
    if (problem := topic_name_problem(name)) is not None:
        raise error(name, *problem)
    full = full_name(name, node_name, namespace)
    if (problem := full_topic_name_problem(full)) is not None:
        raise error(full, *problem)
    return full

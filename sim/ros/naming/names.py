"""Expands the names of topics and services to full names, and checks both."""

import re

from sim.ros.naming.validation import validate_full_topic_name, validate_topic_name

_SUBSTITUTION = re.compile(r"\{([^{}]*)\}")


class UnknownSubstitutionError(ValueError):
    """A substitution in curly braces is unknown."""

    def __init__(self, name: str) -> None:
        super().__init__(f"unknown substitution '{{{name}}}'")


def expand(name: str, node_name: str, namespace: str, *, is_service: bool) -> str:
    """The full name of a topic or service that a node of that name and namespace means.

    Raises:
        InvalidTopicNameException, InvalidServiceNameException: the name breaks the rules.
        UnknownSubstitutionError: the name has an unknown substitution.
    """
    validate_topic_name(name, is_service=is_service)
    full = full_name(name, node_name, namespace)
    validate_full_topic_name(full, is_service=is_service)
    return full


def full_name(name: str, node_name: str, namespace: str) -> str:
    """The full name that a valid name stands for; UnknownSubstitutionError for an unknown substitution."""
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

"""Names of nodes, topics and services: ROS 2's rules for them, and how short ones become full.

Source of the rules: the ROS 2 design article "Topic and service names".
"""

import re

from sim.ros.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
    NameValidationException,
)

_SUBSTITUTION = re.compile(r"\{([^{}]*)\}")
_MAX_LENGTH = 255


def validate_node_name(name: str) -> None:
    """Raise InvalidNodeNameException unless ``name`` is a plain word of letters, digits and underscores."""
    if not name:
        raise InvalidNodeNameException(name, "node name must not be empty", 0)
    if (wrong := re.search(r"[^A-Za-z0-9_]", name)) is not None:
        problem = "node name must not contain characters other than alphanumerics or '_'"
        raise InvalidNodeNameException(name, problem, wrong.start())
    if name[0].isdigit():
        raise InvalidNodeNameException(name, "node name must not start with a number", 0)
    if len(name) > _MAX_LENGTH:
        raise InvalidNodeNameException(name, "node name length should not exceed '255'", _MAX_LENGTH)


def validate_namespace(namespace: str) -> None:
    """Raise InvalidNamespaceException unless ``namespace`` is absolute and well-formed."""
    if not namespace.startswith("/"):
        raise InvalidNamespaceException(namespace, "namespace must be absolute, it must lead with a '/'", 0)
    if namespace == "/":
        return
    found = _first_problem(namespace, "namespace")
    if found is not None:
        raise InvalidNamespaceException(namespace, *found)


def expand_topic(name: str, node_name: str, namespace: str) -> str:
    """The full name of a topic as a node means it.

    Raises:
        InvalidTopicNameException: the name breaks the rules.
    """
    return _expand(name, node_name, namespace, "topic name", InvalidTopicNameException)


def expand_service(name: str, node_name: str, namespace: str) -> str:
    """The full name of a service as a node means it.

    Raises:
        InvalidServiceNameException: the name breaks the rules.
    """
    return _expand(name, node_name, namespace, "service name", InvalidServiceNameException)


class _Problem(Exception):
    def __init__(self, text: str, index: int) -> None:
        super().__init__(text)
        self.text = text
        self.index = index


def _expand(
    name: str,
    node_name: str,
    namespace: str,
    what: str,
    error: type[InvalidTopicNameException] | type[InvalidServiceNameException],
) -> str:
    try:
        full = _joined(_substituted(name, node_name, namespace, what), node_name, namespace)
    except _Problem as problem:
        raise error(name, problem.text, problem.index) from None
    found = _first_problem(full, what)
    if found is not None:
        text, index = found
        shift = max(len(full) - len(name), 0)
        raise error(name, text, max(index - shift, 0))
    return full


def _substituted(name: str, node_name: str, namespace: str, what: str) -> str:
    if not name:
        raise _Problem(f"{what} must not be empty", 0)
    known = {"node": node_name, "ns": namespace, "namespace": namespace}

    def value(match: re.Match[str]) -> str:
        if match[1] not in known:
            raise _Problem(f"unknown substitution '{{{match[1]}}}'", match.start())
        return known[match[1]]

    return _SUBSTITUTION.sub(value, name)


def _joined(name: str, node_name: str, namespace: str) -> str:
    base = "" if namespace == "/" else namespace
    if name.startswith("~"):
        if name != "~" and not name.startswith("~/"):
            raise _Problem("'~' must be followed by '/' or end the name", 1)
        return f"{base}/{node_name}{name[1:]}"
    return name if name.startswith("/") else f"{base}/{name}"


def _first_problem(name: str, what: str) -> tuple[str, int] | None:
    if name.endswith("/"):
        return f"{what} must not end with a forward slash", len(name) - 1
    if (wrong := re.search(r"[^A-Za-z0-9_/]", name)) is not None:
        text = f"{what} must not contain characters other than alphanumerics, '_', '~', '{{', or '}}'"
        return text, wrong.start()
    if (repeated := name.find("//")) >= 0:
        return f"{what} must not contain repeated '/'", repeated + 1
    if (digit := re.search(r"/\d", name)) is not None:
        return f"{what} token must not start with a number", digit.start() + 1
    return None


__all__ = [
    "NameValidationException",
    "expand_service",
    "expand_topic",
    "validate_namespace",
    "validate_node_name",
]

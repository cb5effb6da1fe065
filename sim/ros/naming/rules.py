"""ROS 2's rules for names, each as the first problem of a name: what is wrong, and where.

Source: the ROS 2 design article "Topic and service names"; order and wording of the rules are those of rcl
and rmw. Topics and services share them, wording included.
"""

from __future__ import annotations

import re
from typing import NamedTuple

_MAX_NODE_NAME = 255
_MAX_TOPIC = 247
_MAX_NAMESPACE = 245


class Problem(NamedTuple):
    """What is wrong with a name, and at which character."""

    text: str
    place: int


def node_name_problem(name: str) -> Problem | None:
    """The first problem of a node's name; TypeError for what is no text, here as below."""
    _require_text(name)
    if not name:
        return Problem("node name must not be empty", 0)
    if (wrong := re.search(r"[^A-Za-z0-9_]", name)) is not None:
        text = "node name must not contain characters other than alphanumerics or '_'"
        return Problem(text, wrong.start())
    if name[0].isdigit():
        return Problem("node name must not start with a number", 0)
    if len(name) > _MAX_NODE_NAME:
        return Problem(f"node name length should not exceed '{_MAX_NODE_NAME}'", _MAX_NODE_NAME - 1)
    return None


def namespace_problem(namespace: str) -> Problem | None:
    """The first problem of a namespace."""
    _require_text(namespace)
    if namespace == "/":
        return None
    if namespace.endswith("/") and namespace.startswith("/"):
        return Problem("namespace must not end with a '/', unless only a '/'", len(namespace) - 1)
    if (found := _absolute_problem(namespace, "namespace")) is not None:
        return found
    if len(namespace) > _MAX_NAMESPACE:
        return Problem(f"namespace should not exceed '{_MAX_NAMESPACE}'", _MAX_NAMESPACE - 1)
    return None


def full_topic_name_problem(name: str) -> Problem | None:
    """The first problem of a topic's or service's full name."""
    _require_text(name)
    if name.endswith("/") and name.startswith("/"):
        return Problem("topic name must not end with a '/'", len(name) - 1)
    if (found := _absolute_problem(name, "topic name")) is not None:
        return found
    if len(name) > _MAX_TOPIC:
        return Problem(f"topic length should not exceed '{_MAX_TOPIC}'", _MAX_TOPIC - 1)
    return None


def _absolute_problem(name: str, what: str) -> Problem | None:
    if not name:
        return Problem(f"{what} must not be empty", 0)
    if not name.startswith("/"):
        return Problem(f"{what} must be absolute, it must lead with a '/'", 0)
    if (wrong := re.search(r"[^A-Za-z0-9_/]", name)) is not None:
        text = f"{what} must not contain characters other than alphanumerics, '_', or '/'"
        return Problem(text, wrong.start())
    if (joint := re.search(r"/(?=[/0-9])", name)) is not None:
        if name[joint.end()] == "/":
            return Problem(f"{what} must not contain repeated '/'", joint.end())
        return Problem(f"{what} must not have a token that starts with a number", joint.end())
    return None


def topic_name_problem(name: str) -> Problem | None:
    """The first problem of a topic's or service's name as a program writes it, such as ``~/x``."""
    _require_text(name)
    if not name:
        return Problem("topic name must not be empty string", 0)
    if name.endswith("/"):
        return Problem("topic name must not end with a forward slash", len(name) - 1)
    return _character_problem(name) or _token_problem(name)


def _require_text(name: object) -> None:
    if not isinstance(name, str):
        raise TypeError(f"a name must be a str, not {name!r}")


def _character_problem(name: str) -> Problem | None:
    opened: int | None = None
    for index, character in enumerate(name):
        if re.match(r"[A-Za-z0-9_]", character):
            if character.isdigit() and opened == index - 1:
                return Problem("substitution name must not start with a number", index)
        elif character == "{" and opened is None:
            opened = index
        elif character == "}" and opened is not None:
            opened = None
        elif character in "{}":
            return Problem(_UNBALANCED, index)
        elif character == "~":
            if index > 0:
                text = "topic name must not have tilde '~' unless it is the first character"
                return Problem(text, index)
        elif opened is not None:
            text = "substitution name must not contain characters other than alphanumerics or '_'"
            return Problem(text, index)
        elif character != "/":
            text = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
            return Problem(text, index)
    return None if opened is None else Problem(_UNBALANCED, opened)


def _token_problem(name: str) -> Problem | None:
    if (digit := re.search(r"(?:^|/)(?=[0-9])", name)) is not None:
        return Problem("topic name token must not start with a number", digit.end())
    if re.match(r"~[^/]", name):
        return Problem("topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1)
    return None


_UNBALANCED = "topic name must not have unmatched (unbalanced) curly braces '{}'"

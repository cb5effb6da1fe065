"""ROS 2's rules for names: each function returns the first problem of a name and its place.

Source: the ROS 2 design article "Topic and service names"; order and wording of the rules are those of rcl
and rmw. Topics and services share them, wording included.
"""

import re
from typing import NamedTuple

_MAX_NODE_NAME = 255
_MAX_TOPIC = 247
_MAX_NAMESPACE = 245


class NameProblem(NamedTuple):
    """What is wrong with a name, and the position of the character."""

    text: str
    position: int


def node_name_problem(name: str) -> NameProblem | None:
    """The first problem of a node's name. All functions raise TypeError for a name that is not a str."""
    _require_text(name)
    if not name:
        return NameProblem("node name must not be empty", 0)
    if (wrong := re.search(r"[^A-Za-z0-9_]", name)) is not None:
        text = "node name must not contain characters other than alphanumerics or '_'"
        return NameProblem(text, wrong.start())
    if name[0].isdigit():
        return NameProblem("node name must not start with a number", 0)
    if len(name) > _MAX_NODE_NAME:
        return NameProblem(f"node name length should not exceed '{_MAX_NODE_NAME}'", _MAX_NODE_NAME - 1)
    return None


def namespace_problem(namespace: str) -> NameProblem | None:
    """The first problem of a namespace."""
    _require_text(namespace)
    if namespace == "/":
        return None
    if namespace.endswith("/") and namespace.startswith("/"):
        return NameProblem("namespace must not end with a '/', unless only a '/'", len(namespace) - 1)
    if (found := _absolute_problem(namespace, "namespace")) is not None:
        return found
    if len(namespace) > _MAX_NAMESPACE:
        return NameProblem(f"namespace should not exceed '{_MAX_NAMESPACE}'", _MAX_NAMESPACE - 1)
    return None


def full_topic_name_problem(name: str) -> NameProblem | None:
    """The first problem of a topic's or service's full name."""
    _require_text(name)
    if name.endswith("/") and name.startswith("/"):
        return NameProblem("topic name must not end with a '/'", len(name) - 1)
    if (found := _absolute_problem(name, "topic name")) is not None:
        return found
    if len(name) > _MAX_TOPIC:
        return NameProblem(f"topic length should not exceed '{_MAX_TOPIC}'", _MAX_TOPIC - 1)
    return None


def _absolute_problem(name: str, what: str) -> NameProblem | None:
    if not name:
        return NameProblem(f"{what} must not be empty", 0)
    if not name.startswith("/"):
        return NameProblem(f"{what} must be absolute, it must lead with a '/'", 0)
    if (wrong := re.search(r"[^A-Za-z0-9_/]", name)) is not None:
        text = f"{what} must not contain characters other than alphanumerics, '_', or '/'"
        return NameProblem(text, wrong.start())
    if (joint := re.search(r"/(?=[/0-9])", name)) is not None:
        if name[joint.end()] == "/":
            return NameProblem(f"{what} must not contain repeated '/'", joint.end())
        return NameProblem(f"{what} must not have a token that starts with a number", joint.end())
    return None


def topic_name_problem(name: str) -> NameProblem | None:
    """The first problem of a topic's or service's unexpanded name, such as ``~/x``."""
    _require_text(name)
    if not name:
        return NameProblem("topic name must not be empty string", 0)
    if name.endswith("/"):
        return NameProblem("topic name must not end with a forward slash", len(name) - 1)
    return _character_problem(name) or _token_problem(name)


def _require_text(name: object) -> None:
    if not isinstance(name, str):
        raise TypeError(f"a name must be a str, not {name!r}")


def _character_problem(name: str) -> NameProblem | None:
    opened: int | None = None
    for index, character in enumerate(name):
        if re.match(r"[A-Za-z0-9_]", character):
            if character.isdigit() and opened == index - 1:
                return NameProblem("substitution name must not start with a number", index)
        elif character == "{" and opened is None:
            opened = index
        elif character == "}" and opened is not None:
            opened = None
        elif character in "{}":
            return NameProblem(_UNBALANCED, index)
        elif character == "~":
            if index > 0:
                text = "topic name must not have tilde '~' unless it is the first character"
                return NameProblem(text, index)
        elif opened is not None:
            text = "substitution name must not contain characters other than alphanumerics or '_'"
            return NameProblem(text, index)
        elif character != "/":
            text = "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'"
            return NameProblem(text, index)
    return None if opened is None else NameProblem(_UNBALANCED, opened)


def _token_problem(name: str) -> NameProblem | None:
    if (digit := re.search(r"(?:^|/)(?=[0-9])", name)) is not None:
        return NameProblem("topic name token must not start with a number", digit.end())
    if re.match(r"~[^/]", name):
        return NameProblem(
            "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
        )
    return None


_UNBALANCED = "topic name must not have unmatched (unbalanced) curly braces '{}'"

"""Remapping: rules such as ``odom:=/robot/odom`` that rename nodes, topics and services.

Source of the rules: the ROS 2 design article "Remapping names", and rcl.
"""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum

from sim.ros.exceptions import NameValidationException
from sim.ros.naming.names import expand

_TOKEN = r"[A-Za-z_][A-Za-z0-9_]*"
_NODE_PREFIX = re.compile(rf"({_TOKEN}):")
_RESOURCE = re.compile(rf"~|(~?/)?{_TOKEN}(/{_TOKEN})*")
_NAMESPACE = re.compile(rf"/|(/{_TOKEN})+")
_SCHEMES = ("rostopic://", "rosservice://")


class RemapTarget(Enum):
    """What a rule renames."""

    NODE = "node"
    NAMESPACE = "namespace"
    TOPIC = "topic"
    SERVICE = "service"
    TOPIC_OR_SERVICE = "topic or service"


class RemapRuleError(ValueError):
    """A text is not a remapping rule; the message says why."""


@dataclass(frozen=True, slots=True)
class RemapRule:
    """One rule, for one node or (``node`` None) for every node."""

    target: RemapTarget
    node: str | None
    match: str
    replacement: str


def parse_rule(text: str) -> RemapRule:
    """Read ``from:=to``, ``node:from:=to``, ``__node:=name`` or ``__ns:=/namespace``.

    Raises:
        RemapRuleError: it is not a remapping rule.
    """
    left, sign, right = text.partition(":=")
    if not sign:
        raise RemapRuleError("a rule is written as from:=to")
    node = None
    if (prefix := _NODE_PREFIX.match(left)) is not None and not left.startswith(_SCHEMES):
        node, left = prefix[1], left[prefix.end() :]
    if left in {"__node", "__name"}:
        _require(re.compile(_TOKEN), right, "a node's name")
        return RemapRule(RemapTarget.NODE, node, left, right)
    if left == "__ns":
        _require(_NAMESPACE, right, "a namespace that begins with '/'")
        return RemapRule(RemapTarget.NAMESPACE, node, left, right)
    target, match = _kind(left)
    _require(_RESOURCE, match, "the name of a topic or service")
    _require(_RESOURCE, right, "the name of a topic or service")
    return RemapRule(target, node, match, right)


def is_rule(text: str) -> bool:
    """Whether a text is a remapping rule."""
    try:
        parse_rule(text)
    except RemapRuleError:
        return False
    return True


def _kind(left: str) -> tuple[RemapTarget, str]:
    for scheme, target in zip(_SCHEMES, (RemapTarget.TOPIC, RemapTarget.SERVICE), strict=True):
        if left.startswith(scheme):
            return target, left.removeprefix(scheme)
    return RemapTarget.TOPIC_OR_SERVICE, left


def _require(form: re.Pattern[str], text: str, what: str) -> None:
    if "*" in text:
        raise RemapRuleError("Wildcard '*' is not implemented")
    if not form.fullmatch(text):
        raise RemapRuleError(f"{what} is wanted instead of {text!r}")


class Remapping:
    """The remapping rules of a node; the first rule that fits is applied."""

    def __init__(self, rules: Iterable[RemapRule]) -> None:
        self._rules = tuple(rules)

    def node_name(self, name: str) -> str:
        """The remapped name of a node that the program calls ``name``."""
        return self._replacement(RemapTarget.NODE, name) or name

    def namespace(self, namespace: str, node_name: str) -> str:
        """The remapped namespace of a node; ``node_name`` is the remapped name."""
        return self._replacement(RemapTarget.NAMESPACE, node_name) or namespace

    def renamed(self, full: str, node_name: str, namespace: str, *, is_service: bool) -> str:
        """The name that the node uses for the topic or service of that full name."""
        targets = {RemapTarget.TOPIC_OR_SERVICE, RemapTarget.SERVICE if is_service else RemapTarget.TOPIC}
        for rule in self._rules:
            if rule.target in targets and rule.node in {None, node_name}:
                try:
                    if expand(rule.match, node_name, namespace, is_service=is_service) == full:
                        return expand(rule.replacement, node_name, namespace, is_service=is_service)
                except NameValidationException:
                    continue
        return full

    def _replacement(self, target: RemapTarget, node_name: str) -> str | None:
        fitting = (each for each in self._rules if each.target is target and each.node in {None, node_name})
        return next((each.replacement for each in fitting), None)

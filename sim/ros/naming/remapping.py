"""Remapping: rules such as ``odom:=/robot/odom`` that give a node, its topics and its services other names.

Source of the rules: the ROS 2 design article "Remapping names", and rcl's reading of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum

from sim.ros.exceptions import NameValidationException
from sim.ros.naming.names import expand_service, expand_topic

_TOKEN = r"[A-Za-z_][A-Za-z0-9_]*"
_NODE_PREFIX = re.compile(rf"({_TOKEN}):")
_RESOURCE = re.compile(rf"~|(~?/)?{_TOKEN}(/{_TOKEN})*")
_NAMESPACE = re.compile(rf"/|(/{_TOKEN})+")
_SCHEMES = ("rostopic://", "rosservice://")


class Renamed(Enum):
    """What a rule gives another name to."""

    NODE = "node"
    NAMESPACE = "namespace"
    TOPIC = "topic"
    SERVICE = "service"
    TOPIC_OR_SERVICE = "topic or service"


class RemapRuleError(ValueError):
    """A text is no remapping rule; it says why."""


@dataclass(frozen=True, slots=True)
class RemapRule:
    """One rule; without ``node`` it holds for every node."""

    renamed: Renamed
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
        return RemapRule(Renamed.NODE, node, left, right)
    if left == "__ns":
        _require(_NAMESPACE, right, "a namespace that begins with '/'")
        return RemapRule(Renamed.NAMESPACE, node, left, right)
    renamed, match = _kind(left)
    _require(_RESOURCE, match, "the name of a topic or service")
    _require(_RESOURCE, right, "the name of a topic or service")
    return RemapRule(renamed, node, match, right)


def is_rule(text: str) -> bool:
    """Whether a text is a remapping rule."""
    try:
        parse_rule(text)
    except RemapRuleError:
        return False
    return True


def _kind(left: str) -> tuple[Renamed, str]:
    for scheme, renamed in zip(_SCHEMES, (Renamed.TOPIC, Renamed.SERVICE), strict=True):
        if left.startswith(scheme):
            return renamed, left.removeprefix(scheme)
    return Renamed.TOPIC_OR_SERVICE, left


def _require(form: re.Pattern[str], text: str, what: str) -> None:
    if "*" in text:
        raise RemapRuleError("Wildcard '*' is not implemented")
    if not form.fullmatch(text):
        raise RemapRuleError(f"{what} is wanted instead of {text!r}")


class Remapping:
    """The rules that hold for a node, the first that fits first."""

    def __init__(self, rules: Iterable[RemapRule]) -> None:
        self._rules = tuple(rules)

    def node_name(self, name: str) -> str:
        """The name of the node that calls itself ``name``."""
        return self._replaced(Renamed.NODE, name) or name

    def namespace(self, namespace: str, node_name: str) -> str:
        """The namespace of a node; its name is the one it has got."""
        return self._replaced(Renamed.NAMESPACE, node_name) or namespace

    def topic(self, full: str, node_name: str, namespace: str) -> str:
        """What the node uses for the topic of that full name."""
        return self._renamed(full, Renamed.TOPIC, expand_topic, node_name, namespace)

    def service(self, full: str, node_name: str, namespace: str) -> str:
        """What the node uses for the service of that full name."""
        return self._renamed(full, Renamed.SERVICE, expand_service, node_name, namespace)

    def _replaced(self, renamed: Renamed, node_name: str) -> str | None:
        fitting = (each for each in self._rules if each.renamed is renamed and each.node in {None, node_name})
        return next((each.replacement for each in fitting), None)

    def _renamed(
        self, full: str, kind: Renamed, expand: Callable[[str, str, str], str], node_name: str, namespace: str
    ) -> str:
        for rule in self._rules:
            if rule.renamed in {kind, Renamed.TOPIC_OR_SERVICE} and rule.node in {None, node_name}:
                try:
                    if expand(rule.match, node_name, namespace) == full:
                        return expand(rule.replacement, node_name, namespace)
                except NameValidationException:
                    continue
        return full

"""Names on the network: what is hidden, what has which type, and candidates for completion."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from itertools import chain
from typing import Any

from sim.interfaces import type_name
from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.expand_topic_name import expand_topic_name
from sim.ros.naming.validate_full_topic_name import validate_full_topic_name
from sim.ros.node.graph import NamesAndTypes, nodes_on
from sim.ros.node.node import Node
from sim.shell.parser import Completer, Surroundings
from sim.shell.session import CommandFailed, ShellSession


def is_hidden(name: str) -> bool:
    """Whether a part of the name begins with an underscore, so that lists leave it out."""
    return any(part.startswith("_") for part in name.split("/"))


def without_hidden(found: NamesAndTypes, include_hidden: bool) -> NamesAndTypes:
    """The names that a list shows."""
    return [(name, types) for name, types in found if include_hidden or not is_hidden(name)]


def full_topic_name(session: ShellSession, topic: str) -> str:
    """The full name of a topic; raises CommandFailed if the name breaks the rules."""
    node = session.node
    try:
        full: str = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(full)
    except (ValueError, InvalidTopicNameException, InvalidServiceNameException) as error:
        raise CommandFailed(str(error)) from None
    return full


def topic_types(session: ShellSession, topic: str) -> list[str] | None:
    """The types of a topic, None if nobody speaks of it."""
    full = full_topic_name(session, topic)
    session.want(full)
    return dict(session.node.get_topic_names_and_types()).get(full)


def topic_type(session: ShellSession, topic: str) -> str | None:
    """The type of a topic, None if nobody speaks of it; raises CommandFailed if it has more than one."""
    types = topic_types(session, topic)
    if types is None:
        return None
    if len(types) > 1:
        raise CommandFailed(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    return types[0]


def absolute(node_name: str) -> str:
    """A node's full name, with the slash that a line may leave out."""
    return node_name if node_name.startswith("/") else f"/{node_name}"


# Candidates


def _ends(
    surroundings: Surroundings, of: Callable[[Node], Iterable[tuple[str, Any]]]
) -> dict[str, list[str]]:
    host = surroundings.host
    found: defaultdict[str, set[str]] = defaultdict(set)
    with host.lock:
        for name, kind in chain.from_iterable(map(of, nodes_on(host.network))):
            found[name].add(type_name(kind))
    return {name: sorted(types) for name, types in found.items()}


def known_topics(surroundings: Surroundings) -> dict[str, list[str]]:
    """Every topic and its types."""

    def ends(node: Node) -> list[tuple[str, Any]]:
        heard = [(each.topic_name, each.msg_type) for each in node.subscriptions]
        return heard + [(each.topic_name, each.msg_type) for each in node.publishers]

    return _ends(surroundings, ends)


def known_services(surroundings: Surroundings) -> dict[str, list[str]]:
    """Every service and its types."""
    return _ends(surroundings, lambda node: [(each.name, each.srv_type) for each in node.services])


def known_nodes(surroundings: Surroundings) -> list[str]:
    """Every node that is not hidden."""
    with surroundings.host.lock:
        nodes = nodes_on(surroundings.host.network)
    names = [node.get_fully_qualified_name() for node in nodes]
    return [name for name in names if not is_hidden(name)]


def known_parameters(surroundings: Surroundings) -> list[str]:
    """The parameters of the node that was given first, known even while nobody spins it."""
    wanted = absolute(surroundings.given[0])
    with surroundings.host.lock:
        for node in nodes_on(surroundings.host.network):
            if node.get_fully_qualified_name() == wanted:
                return list(node.list_parameters([], 0).names)
    return []


def type_of_given(known: Callable[[Surroundings], dict[str, list[str]]]) -> Completer:
    """Candidates for a type: those of the name that was given before."""
    return lambda surroundings: known(surroundings).get(surroundings.given[0], [])

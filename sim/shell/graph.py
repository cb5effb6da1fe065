"""Names on the network: hidden names, types of topics, and candidates for completion."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeAlias

from sim.interfaces import Kind, names, packages
from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.expand_topic_name import expand_topic_name
from sim.ros.naming.validation import validate_full_topic_name
from sim.shell.parser import Completer, Surroundings
from sim.shell.session import CommandFailed, ShellSession

NamesAndTypes: TypeAlias = list[tuple[str, list[str]]]


def is_hidden(name: str) -> bool:
    """Return whether a part of a name begins with an underscore; lists leave such names out."""
    return any(part.startswith("_") for part in name.split("/"))


def without_hidden(found: NamesAndTypes, include_hidden: bool) -> NamesAndTypes:
    """Return the names that a list shows."""
    return [(name, types) for name, types in found if include_hidden or not is_hidden(name)]


def shown(found: NamesAndTypes, with_types: bool) -> Iterator[str]:
    """Return the lines of a list: names, with their types if ``with_types``."""
    return (f"{name} [{', '.join(types)}]" if with_types else name for name, types in found)


def full_topic_name(session: ShellSession, topic: str) -> str:
    """Return the full name of a topic; raise CommandFailed if the name is not valid."""
    node = session.node
    try:
        full: str = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(full)
    except (ValueError, InvalidTopicNameException, InvalidServiceNameException) as error:
        raise CommandFailed(str(error)) from None
    return full


def topic_types(session: ShellSession, topic: str) -> list[str] | None:
    """Return the types of a topic; None if it does not exist."""
    full = full_topic_name(session, topic)
    session.ground.want(full)
    return dict(session.node.get_topic_names_and_types()).get(full)


def topic_type(session: ShellSession, topic: str) -> str | None:
    """Return the type of a topic; None if it does not exist. Raise CommandFailed if it has several."""
    types = topic_types(session, topic)
    if types is None:
        return None
    if len(types) > 1:
        raise CommandFailed(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]"
        )
    return types[0]


def absolute(node_name: str) -> str:
    """Return a node's full name, with the slash that a line may omit."""
    return node_name if node_name.startswith("/") else f"/{node_name}"


# Candidates


def known_topics(surroundings: Surroundings) -> dict[str, list[str]]:
    """Every topic and its types."""
    return surroundings.ground.topics()


def known_services(surroundings: Surroundings) -> dict[str, list[str]]:
    """Every service and its types."""
    return surroundings.ground.services()


def known_nodes(surroundings: Surroundings) -> list[str]:
    """Every node that is not hidden."""
    return [name for name in surroundings.ground.nodes() if not is_hidden(name)]


def known_parameters(surroundings: Surroundings) -> list[str]:
    """The parameters of the node that was given first."""
    return surroundings.ground.parameters(absolute(surroundings.given[0]))


def type_of_given(
    known: Callable[[Surroundings], dict[str, list[str]]], kind: Kind | None = None
) -> Completer:
    """Return a completer for the types of the name that was given first, or for all types of a kind."""

    def candidates(surroundings: Surroundings) -> list[str]:
        found = known(surroundings).get(surroundings.given[0], [])
        return found or ([] if kind is None else type_names(kind))

    return candidates


def type_names(kind: Kind, package: str | None = None) -> list[str]:
    """Return the full names of every interface of a kind, of one package or of all."""
    chosen = sorted(packages()) if package is None else [package]
    return [f"{each}/{kind}/{name}" for each in chosen for name in names(each, kind)]

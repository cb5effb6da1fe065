"""``ros2 interface``: message, service and action types, and their definitions."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Iterable

from sim.interfaces import (
    Kind,
    Message,
    UnknownInterfaceError,
    interface_text,
    message_of_type,
    names,
    packages,
)
from sim.shell.graph import type_names
from sim.shell.messages import message_class, prototype_of, prototype_word, service_class
from sim.shell.parser import LineParser, Surroundings
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb

_TITLES: dict[Kind, str] = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def known_messages(_: Surroundings) -> list[str]:
    """Candidates for a message type."""
    return type_names("msg")


def known_service_types(_: Surroundings) -> list[str]:
    """Candidates for a service type."""
    return type_names("srv")


def _known_packages(_: Surroundings) -> Iterable[str]:
    return packages()


def _known_interfaces(_: Surroundings) -> list[str]:
    return [name for kind in _TITLES for name in type_names(kind)]


def message_prototype(surroundings: Surroundings) -> list[str]:
    """A default message of the type that was given second, quoted for a shell."""
    return [prototype_word(message_class(surroundings.ground, surroundings.given[1]))]


def service_prototype(surroundings: Surroundings) -> list[str]:
    """A default request of the type that was given second, quoted for a shell."""
    return [prototype_word(service_class(surroundings.ground, surroundings.given[1]).Request)]


def _add_list(parser: LineParser) -> None:
    parser.flag("-m", "--only-msgs", help="Print out only the message types")
    parser.flag("-s", "--only-srvs", help="Print out only the service types")
    parser.flag("-a", "--only-actions", help="Print out only the action types")


def _list(session: ShellSession, arguments: Namespace) -> None:
    for kind in _chosen_kinds(arguments):
        session.say(f"{_TITLES[kind]}:")
        session.say_each(f"    {name}" for name in type_names(kind))


def _add_package(parser: LineParser) -> None:
    parser.argument(
        "package_name", help="Name of the ROS package (e.g. 'example_interfaces')", completer=_known_packages
    )
    _add_list(parser)


def _package(session: ShellSession, arguments: Namespace) -> None:
    if arguments.package_name not in packages():
        raise CommandFailed(f"Unknown package '{arguments.package_name}'")
    for kind in _chosen_kinds(arguments):
        session.say_each(type_names(kind, arguments.package_name))


def _packages(session: ShellSession, arguments: Namespace) -> None:
    kinds = _chosen_kinds(arguments)
    session.say_each(each for each in sorted(packages()) if any(names(each, kind) for kind in kinds))


def _chosen_kinds(arguments: Namespace) -> list[Kind]:
    """Return the kinds that the options select; without any, all."""
    wanted = {"msg": arguments.only_msgs, "srv": arguments.only_srvs, "action": arguments.only_actions}
    return [kind for kind in _TITLES if wanted[kind]] or list(_TITLES)


def _add_show(parser: LineParser) -> None:
    parser.argument(
        "type",
        help="Show an interface definition (e.g. 'example_interfaces/msg/String'). Passing '-' reads the "
        "argument from stdin, which there is none of here",
        completer=_known_interfaces,
    )
    comments = parser.add_mutually_exclusive_group()
    comments.add_argument(
        "--all-comments",
        action="store_true",
        help="Show all comments, including for sub-interface definitions",
    )
    comments.add_argument("--no-comments", action="store_true", help="Show no comments or whitespace")


def _show(session: ShellSession, arguments: Namespace) -> None:
    try:
        text = interface_text(arguments.type)
    except UnknownInterfaceError as error:
        raise CommandFailed(f"Unknown interface '{arguments.type}': {error}") from None
    session.say((_without_comments(text) if arguments.no_comments else text).rstrip("\n"))


def _without_comments(text: str) -> str:
    lines = (
        line if '"' in line or "'" in line else line.partition("#")[0].rstrip() for line in text.splitlines()
    )
    return "\n".join(line for line in lines if line.strip())


def _add_proto(parser: LineParser) -> None:
    parser.argument(
        "type",
        help="Show an interface definition (e.g. 'example_interfaces/msg/String')",
        completer=_known_interfaces,
    )
    parser.flag("--no-quotes", help="if true output has no outer quotes.")


def _proto(session: ShellSession, arguments: Namespace) -> None:
    quote = "" if arguments.no_quotes else '"'
    session.say(f"{quote}{prototype_of(_first_part(arguments.type))}{quote}")


def _first_part(name: str) -> type[Message]:
    """Return the class of a message, a service's request or an action's goal."""
    ending = {"srv": "_Request", "action": "_Goal"}.get(name.partition("/")[2].partition("/")[0], "")
    try:
        return message_of_type(f"{name}{ending}")
    except UnknownInterfaceError as error:
        raise CommandFailed(f"Unknown interface '{name}': {error}") from None


INTERFACE = ShellCommand(
    "interface",
    "Show information about ROS interfaces",
    (
        Verb("list", "List all interface types available", _add_list, _list),
        Verb(
            "package", "Output a list of available interface types within one package", _add_package, _package
        ),
        Verb("packages", "Output a list of packages that provide interfaces", _add_list, _packages),
        Verb("proto", "Output an interface prototype", _add_proto, _proto),
        Verb("show", "Output the interface definition", _add_show, _show),
    ),
)

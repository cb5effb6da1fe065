"""``ros2 param``: lists, reads and sets the parameters of nodes through their services."""

from __future__ import annotations

import re
from argparse import Namespace
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from sim.files import plain_yaml
from sim.files.atomic import write_atomically
from sim.ros.node.parameter_client import AsyncParameterClient
from sim.ros.parameters.parameter import (
    Parameter,
    get_parameter_value,
    parameter_dict_from_yaml_file,
    parameter_value_to_python,
)
from sim.ros.parameters.yaml_files import ParameterYamlError
from sim.ros.scheduling.task import Future
from sim.shell.graph import absolute, is_hidden, known_nodes, known_parameters
from sim.shell.parser import LineParser
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options, add_hidden_nodes_option

_SERVICES_PATIENCE = 5.0
_REPLY_PATIENCE = 1.0
"""Seconds for which ``list`` waits for a node's services and for its reply."""


def _add_node(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.argument("node_name", help="Name of the ROS node", completer=known_nodes)
    add_hidden_nodes_option(parser)


def _add_parameter(parser: LineParser) -> None:
    _add_node(parser)
    parser.argument("parameter_name", help="Name of the parameter", completer=known_parameters)


# Names of types


def _type_word(kind: int) -> str:
    name: str = Parameter.Type(kind).name
    return name.lower().replace("bool", "boolean").replace("_", " ")


def _label(kind: int) -> str:
    """``Boolean value is:``, ``Integer values are:``."""
    element, array, _ = _type_word(kind).partition(" array")
    return f"{element.capitalize()} {'values are' if array else 'value is'}:"


# Requests


def _node_names(session: ShellSession, arguments: Namespace) -> list[str]:
    every = session.node.get_fully_qualified_node_names()
    return sorted(name for name in every if arguments.include_hidden_nodes or not is_hidden(name))


def _client(session: ShellSession, arguments: Namespace) -> AsyncParameterClient:
    """Return a client for the line's node; raise CommandFailed if it does not exist."""
    name = absolute(arguments.node_name)
    if name not in _node_names(session, arguments):
        raise CommandFailed("Node not found")
    client = AsyncParameterClient(session.node, name)
    session.wait_until(client.services_are_ready)
    return client


def _reply(session: ShellSession, future: Future[Any]) -> Any:
    session.spin(future)
    return future.result()


def _ready_in_time(session: ShellSession, client: AsyncParameterClient) -> bool:
    end = session.ground.now() + int(_SERVICES_PATIENCE * 1e9)
    session.wait_until(lambda: client.services_are_ready() or session.ground.now() >= end)
    return client.services_are_ready()


# list


def _add_list(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.argument("node_name", nargs="?", help="Name of the ROS node", completer=known_nodes)
    add_hidden_nodes_option(parser)
    parser.add_argument(
        "--param-prefixes", nargs="+", default=[], help="Only list parameters with the provided prefixes"
    )
    parser.flag("--param-type", help="Print parameter types with parameter names")
    parser.add_argument("--filter", help="Only list parameters matching the provided regex")


def _list(session: ShellSession, arguments: Namespace) -> None:
    names = _node_names(session, arguments)
    if arguments.node_name is not None:
        names = [name for name in names if name == absolute(arguments.node_name)]
        if not names:
            raise CommandFailed("Node not found")
    try:
        wanted = re.compile(arguments.filter or "")
    except re.error as error:
        raise CommandFailed(f"The filter '{arguments.filter}' is no regular expression: {error}") from None
    for name in names:
        client = AsyncParameterClient(session.node, name)
        found = _listed(session, client, arguments.param_prefixes)
        if found is None:
            continue
        if arguments.node_name is None:
            session.say(f"{name}:")
        lines = _with_types(session, client, filter(wanted.match, found), arguments.param_type)
        session.say_each(f"  {line}" for line in lines)


def _listed(session: ShellSession, client: AsyncParameterClient, prefixes: list[str]) -> list[str] | None:
    """Return the names of a node's parameters; print why and return None if it does not reply in time."""
    name = client.remote_node_name
    if not _ready_in_time(session, client):
        session.complain(f"Wait for service timed out waiting for parameter services for node {name}")
        return None
    future = client.list_parameters(prefixes)
    if not session.spin(future, _REPLY_PATIENCE):
        session.complain(f"Exception while calling service of node '{name}': None")
        return None
    response: Any = future.result()
    return sorted(response.result.names)


def _with_types(
    session: ShellSession, client: AsyncParameterClient, found: Iterable[str], with_types: bool
) -> list[str]:
    names = list(found)
    if not with_types or not names:
        return names
    types = _reply(session, client.get_parameter_types(names)).types
    return [f"{name} (type: {_type_word(of)})" for name, of in zip(names, types, strict=True)]


# get, set, delete


def _add_get(parser: LineParser) -> None:
    _add_parameter(parser)
    parser.flag("--hide-type", help="Hide the type information")


def _get(session: ShellSession, arguments: Namespace) -> None:
    response = _reply(session, _client(session, arguments).get_parameters([arguments.parameter_name]))
    if not response.values:
        raise CommandFailed("Parameter not set.")
    (message,) = response.values
    value = parameter_value_to_python(message)
    if value is None:
        session.say("Parameter not set.")
    elif arguments.hide_type:
        session.say(str(value))
    else:
        session.say(f"{_label(message.type)} {value}")


def _add_set(parser: LineParser) -> None:
    _add_parameter(parser)
    parser.argument("value", help="Value of the parameter")


def _set(session: ShellSession, arguments: Namespace) -> None:
    message = Parameter(arguments.parameter_name).to_parameter_msg()
    message.value = get_parameter_value(arguments.value)
    result = _reply(session, _client(session, arguments).set_parameters([message])).results[0]
    reason = f": {result.reason}" if result.reason else ""
    if not result.successful:
        raise CommandFailed(f"Setting parameter failed{reason}")
    session.say(f"Set parameter successful{reason}")


def _delete(session: ShellSession, arguments: Namespace) -> None:
    result = _reply(
        session, _client(session, arguments).delete_parameters([arguments.parameter_name])
    ).results[0]
    if not result.successful:
        raise CommandFailed(f"Deleting parameter failed{f': {result.reason}' if result.reason else ''}")
    session.say("Deleted parameter successfully")


# describe


def _add_describe(parser: LineParser) -> None:
    _add_node(parser)
    parser.argument("parameter_names", nargs="+", help="Names of the parameters", completer=known_parameters)


def _describe(session: ShellSession, arguments: Namespace) -> None:
    client = _client(session, arguments)
    descriptors = _reply(session, client.describe_parameters(arguments.parameter_names)).descriptors
    if not descriptors:
        raise CommandFailed(f"Parameter not declared: {', '.join(arguments.parameter_names)}")
    for descriptor in descriptors:
        session.say_each(_description(descriptor))


def _description(descriptor: Any) -> Iterable[str]:
    yield f"Parameter name: {descriptor.name}"
    yield f"  Type: {_type_word(descriptor.type)}"
    if descriptor.description:
        yield f"  Description: {descriptor.description}"
    yield "  Constraints:"
    if descriptor.read_only:
        yield "    Read only: true"
    for limits in (*descriptor.floating_point_range, *descriptor.integer_range):
        yield f"    Min value: {limits.from_value}"
        yield f"    Max value: {limits.to_value}"
        if limits.step:
            yield f"    Step: {limits.step}"
    if descriptor.additional_constraints:
        yield f"    Additional constraints: {descriptor.additional_constraints}"


# dump, load


def _add_dump(parser: LineParser) -> None:
    _add_node(parser)
    parser.add_argument("--output-dir", help="The absolute path where to save the generated file")


def _dump(session: ShellSession, arguments: Namespace) -> None:
    client = _client(session, arguments)
    names = sorted(_reply(session, client.list_parameters()).result.names)
    tree: dict[str, Any] = {}
    for name in names:
        response = _reply(session, client.get_parameters([name]))
        if response.values:
            _put(tree, name.split("."), parameter_value_to_python(response.values[0]))
    full = absolute(arguments.node_name)
    text = plain_yaml.dump({full: {"ros__parameters": tree}})
    if arguments.output_dir is None:
        session.say(text)
        return
    path = Path(arguments.output_dir) / f"{full[1:].replace('/', '__')}.yaml"
    try:
        write_atomically(path, text.encode())
    except OSError as error:
        raise CommandFailed(f"Error writing {path}: {error.strerror}") from None
    session.say(f"Saving to:  {path}")


def _put(tree: dict[str, Any], parts: list[str], value: Any) -> None:
    *outer, last = parts
    for part in outer:
        tree = tree.setdefault(part, {})
    tree[last] = value


def _add_load(parser: LineParser) -> None:
    _add_node(parser)
    parser.argument("parameter_file", help="Parameter file")
    parser.flag("--no-use-wildcard", help="Do not load parameters in the '/**' namespace into the node")


def _load(session: ShellSession, arguments: Namespace) -> None:
    client = _client(session, arguments)
    name = client.remote_node_name
    try:
        parameters = parameter_dict_from_yaml_file(
            arguments.parameter_file, not arguments.no_use_wildcard, target_nodes=[name]
        )
    except OSError as error:
        raise CommandFailed(f"{arguments.parameter_file}: {error.strerror}") from None
    except (RuntimeError, ParameterYamlError) as error:
        raise CommandFailed(f"{arguments.parameter_file}: {error}") from None
    results = _reply(session, client.set_parameters(list(parameters.values()))).results
    for parameter, result in zip(parameters, results, strict=True):
        reason = f": {result.reason}" if result.reason else ""
        if result.successful:
            session.say(f"Set parameter {parameter} successful{reason}")
        else:
            session.complain(f"Set parameter {parameter} failed{reason}")


PARAM = ShellCommand(
    "param",
    "Various param related sub-commands",
    (
        Verb("delete", "Delete parameter", _add_parameter, _delete),
        Verb("describe", "Show descriptive information about declared parameters", _add_describe, _describe),
        Verb("dump", "Show all of the parameters of a node in a YAML file format", _add_dump, _dump),
        Verb("get", "Get parameter", _add_get, _get),
        Verb("list", "Output a list of available parameters", _add_list, _list),
        Verb("load", "Load parameter file for a node", _add_load, _load),
        Verb("set", "Set parameter", _add_set, _set),
    ),
)

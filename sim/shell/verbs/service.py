"""``ros2 service``: calls and lists services."""

from __future__ import annotations

from argparse import Namespace
from typing import Any

from sim.files import plain_yaml
from sim.interfaces.rosidl_runtime_py import message_to_csv, message_to_ordereddict
from sim.ros.entities.client import Client
from sim.ros.qos.qos import qos_profile_services_default
from sim.shell.graph import known_services, shown, type_of_given, without_hidden
from sim.shell.messages import Outgoing, given_values, service_class
from sim.shell.parser import LineParser, positive_float
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.interface import known_service_types, service_prototype
from sim.shell.verbs.verb import ShellCommand, Verb, add_graph_options

_EVENTS = "/_service_event"
_EVENT_NAMES = ("REQUEST_SENT", "REQUEST_RECEIVED", "RESPONSE_SENT", "RESPONSE_RECEIVED")
"""The kinds of service_msgs/msg/ServiceEventInfo by their numbers."""


def _add_call(parser: LineParser) -> None:
    parser.argument(
        "service_name",
        help="Name of the ROS service to call to (e.g. '/add_two_ints')",
        completer=known_services,
    )
    parser.argument(
        "service_type",
        help="Type of the ROS service (e.g. 'std_srvs/srv/Empty')",
        completer=type_of_given(known_services, "srv"),
    )
    parser.argument(
        "values",
        nargs="?",
        default="{}",
        help='Values to fill the service request with in YAML format (e.g. "{a: 1, b: 2}"), otherwise the '
        "service request will be published with default values",
        completer=service_prototype,
    )
    parser.add_argument(
        "-r", "--rate", metavar="N", type=positive_float, help="Repeat the call at a specific rate in Hz"
    )


def _call(session: ShellSession, arguments: Namespace) -> None:
    srv_type = service_class(session.ground, arguments.service_type)
    values = given_values(arguments.values)
    client = session.node.create_client(srv_type, arguments.service_name)
    outgoing = Outgoing(srv_type.Request, values)
    if not client.service_is_ready():
        session.say("waiting for service to become available...")
        session.wait_until(client.service_is_ready)
    now = session.ground.now
    while True:
        began = now()
        outgoing.stamp(session.node.get_clock().now().to_msg())
        _request(session, client, outgoing.message)
        if arguments.rate is None:
            return
        session.sleep(1.0 / arguments.rate - (now() - began) / 1e9)


def _request(session: ShellSession, client: Client, request: Any) -> None:
    session.say(f"requester: making request: {request!r}\n")
    future = client.call_async(request)
    session.spin(future)
    session.say(f"response:\n{future.result()!r}\n")


def _add_service(parser: LineParser) -> None:
    parser.argument(
        "service_name", help="Name of the ROS service (e.g. '/add_two_ints')", completer=known_services
    )
    add_graph_options(parser)


def _add_hidden(parser: LineParser) -> None:
    parser.flag("--include-hidden-services", help="Consider hidden services as well")


def _add_count(parser: LineParser) -> None:
    parser.flag("-c", "--count-services", help="Only display the number of services discovered")


def _add_list(parser: LineParser) -> None:
    add_graph_options(parser)
    parser.flag("-t", "--show-types", help="Additionally show the service type")
    _add_count(parser)
    _add_hidden(parser)


def _list(session: ShellSession, arguments: Namespace) -> None:
    services = without_hidden(session.node.get_service_names_and_types(), arguments.include_hidden_services)
    session.say_each(shown(services, arguments.show_types), arguments.count_services)


def _types_of(session: ShellSession, service: str) -> list[str]:
    full = session.node.resolve_service_name(service)
    session.ground.want(full)
    types = dict(session.node.get_service_names_and_types()).get(full)
    if types is None:
        raise CommandFailed(f"Unknown service '{service}'")
    return types


def _type(session: ShellSession, arguments: Namespace) -> None:
    session.say_each(_types_of(session, arguments.service_name))


def _info(session: ShellSession, arguments: Namespace) -> None:
    types = _types_of(session, arguments.service_name)
    session.say(f"Type: {types[0] if len(types) == 1 else types}")
    session.say(f"Clients count: {session.node.count_clients(arguments.service_name)}")
    session.say(f"Services count: {session.node.count_services(arguments.service_name)}")


def _add_find(parser: LineParser) -> None:
    parser.argument(
        "service_type",
        help="Name of the ROS service type to filter for (e.g. 'rcl_interfaces/srv/ListParameters')",
        completer=known_service_types,
    )
    add_graph_options(parser)
    _add_count(parser)
    _add_hidden(parser)


def _find(session: ShellSession, arguments: Namespace) -> None:
    services = without_hidden(session.node.get_service_names_and_types(), arguments.include_hidden_services)
    found = [name for name, types in services if arguments.service_type in types]
    session.say_each(found, arguments.count_services)


def _add_echo(parser: LineParser) -> None:
    _add_service(parser)
    parser.argument(
        "service_type",
        nargs="?",
        help="Type of the ROS service (e.g. 'example_interfaces/srv/AddTwoInts')",
        completer=type_of_given(known_services, "srv"),
    )
    parser.flag("--csv", help="Output all recursive fields separated by commas")
    parser.flag("--flow-style", help="Print collections in the block style")


def _echo(session: ShellSession, arguments: Namespace) -> None:
    """Print the service events of clients and services that are configured for introspection."""
    topic = f"{session.node.resolve_service_name(arguments.service_name)}{_EVENTS}"
    if arguments.service_type is None:
        (kind, *_) = _types_of(session, arguments.service_name)
    else:
        kind = arguments.service_type
    event_type = service_class(session.ground, kind).Event

    def show(event: Any) -> None:
        if arguments.csv:
            session.say(message_to_csv(event))
        else:
            values = message_to_ordereddict(event)
            values["info"]["event_type"] = _EVENT_NAMES[event.info.event_type]
            session.say(f"{plain_yaml.dump(values, flow_style=arguments.flow_style)}---")

    session.node.create_subscription(event_type, topic, show, qos_profile_services_default)
    if not session.node.get_publishers_info_by_topic(topic):
        session.complain(
            f"WARNING: nobody tells of calls of '{arguments.service_name}' yet: "
            "its service or client has to call configure_introspection"
        )
    session.spin()


SERVICE = ShellCommand(
    "service",
    "Various service related sub-commands",
    (
        Verb("call", "Call a service", _add_call, _call),
        Verb("echo", "Echo a service", _add_echo, _echo),
        Verb("find", "Output a list of available services of a given type", _add_find, _find),
        Verb("info", "Print information about a service", _add_service, _info),
        Verb("list", "Output a list of available services", _add_list, _list),
        Verb("type", "Output a service's type", _add_service, _type),
    ),
)

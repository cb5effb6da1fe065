"""``ros2 service``: what it prints, waits for and refuses."""

import pytest

from sim.interfaces import service
from sim.ros.entities.service_introspection import ServiceIntrospectionState
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.trace.events import EntityAppeared, NodeAppeared, ServiceCalled, ServiceReplied
from tests.shell.lines import carry_out, spin
from tests.support.simulation import Simulation

SetBool = service("std_srvs", "SetBool")
Empty = service("std_srvs", "Empty")

_CALLED = (
    "requester: making request: std_srvs.srv.SetBool_Request(data=False)\n"
    "\n"
    "response:\n"
    "std_srvs.srv.SetBool_Response(success=True, message='TURNING')\n"
    "\n"
)


def dummy_server(simulation: Simulation) -> None:
    """The course's server, which takes 5 s for an answer."""
    node = Node("service_start_turn")

    def turn(_request: object, response: object) -> object:
        simulation.sleep(5.0)
        response.success, response.message = True, "TURNING"  # type: ignore[attr-defined]
        return response

    node.create_service(SetBool, "/dummy_server_srv", turn)
    node.create_service(Empty, "/reset_world", lambda _, response: response)
    spin(simulation, node)


@pytest.mark.parametrize("ending", ["", "\\"])
def test_the_courses_call_prints_request_and_response(ending: str) -> None:
    line = f"ros2 service call /dummy_server_srv std_srvs/srv/SetBool data:\\ false{ending}"
    result = carry_out(line, dummy_server)
    assert (result.out, result.err, result.status) == (_CALLED, "", 0)
    assert [each.at for each in result.said] == [0.0, 0.0, 5.0, 5.0, 5.0]


def test_the_courses_reset_prints_request_and_response() -> None:
    result = carry_out('ros2 service call /reset_world std_srvs/srv/Empty "{}"', dummy_server)
    assert result.out == (
        "requester: making request: std_srvs.srv.Empty_Request()\n\n"
        "response:\nstd_srvs.srv.Empty_Response()\n\n"
    )


def test_a_call_is_on_the_trace_and_its_node_is_not() -> None:
    trace = carry_out("service call /dummy_server_srv std_srvs/SetBool 'data: true'", dummy_server).trace
    (call,), (reply,) = trace.of(ServiceCalled), trace.of(ServiceReplied)
    assert call.call == reply.call
    assert call.request == "std_srvs.srv.SetBool_Request(data=True)"
    assert [each.name for each in trace.of(NodeAppeared)] == ["/service_start_turn"]
    assert {each.name for each in trace.of(EntityAppeared)} == {"/dummy_server_srv", "/reset_world"}


def test_a_call_waits_for_the_service_to_come_up() -> None:
    def later(simulation: Simulation) -> None:
        def come_up() -> None:
            simulation.sleep(2.0)
            dummy_server(simulation)

        simulation.start(come_up)

    result = carry_out("service call /reset_world std_srvs/srv/Empty", later)
    assert result.out.startswith("waiting for service to become available...\nrequester: making request: ")
    assert result.status == 0


def test_an_interrupted_wait_ends_at_once_as_ros2_does() -> None:
    result = carry_out("service call /nowhere std_srvs/srv/Empty", interrupt_at=1.23, until=5.0)
    assert result.out == "waiting for service to become available...\n"
    assert result.status == 2


def test_a_call_that_gets_no_answer_can_be_interrupted() -> None:
    line = "service call /dummy_server_srv std_srvs/srv/SetBool 'data: false'"
    result = carry_out(line, dummy_server, interrupt_at=2.0)
    assert result.out.startswith("requester: making request")
    assert (result.status, len(result.said)) == (2, 2)


def test_calls_are_repeated_at_the_rate_that_is_asked_for() -> None:
    line = "service call -r 2 /reset_world std_srvs/srv/Empty"
    trace = carry_out(line, dummy_server, interrupt_at=1.7).trace
    assert [each.t / 1e9 for each in trace.of(ServiceCalled)] == [0.0, 0.5, 1.0, 1.5]


@pytest.mark.parametrize(
    ("line", "complaint", "status"),
    [
        ("service call /s std_srvs/srv/SetBoll", "The passed service type is invalid: std_srvs has no service "  # noqa: E501
         "'SetBoll'; did you mean 'SetBool'?\n", 1),
        ("service call /s SetBool", "The passed service type is invalid: 'SetBool' is not of the form "
         "package/srv/Name\n", 1),
        ("service call /s std_srvs/srv/SetBool data:false", "Failed to populate field: Value 'data:false' is "
         "expected to be a dictionary but is a str\n", 1),
        ("service call /s std_srvs/srv/SetBool '{data: '", "The passed value needs to be a dictionary in YAML "  # noqa: E501
         "format: did not find expected node content (line 1)\n", 1),
        ("service type /s", "Unknown service '/s'\n", 1),
        ("service info /s", "Unknown service '/s'\n", 1),
        ("service call 'bad name' std_srvs/srv/Empty", "Invalid service name: "
         "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}':\n"
         "  'bad name'\n      ^\n", 1),
    ],
)  # fmt: skip
def test_a_wrong_line_says_what_is_wrong(line: str, complaint: str, status: int) -> None:
    result = carry_out(line)
    assert (result.out, result.err, result.status) == ("", complaint, status)


def test_echo_prints_what_an_introspected_service_tells() -> None:
    def introspected(simulation: Simulation) -> None:
        node = Node("server")
        served = node.create_service(Empty, "/s", lambda _, response: response)
        served.configure_introspection(
            node.get_clock(), QoSProfile(depth=10), ServiceIntrospectionState.METADATA
        )
        client = node.create_client(Empty, "/s")
        spin(simulation, node)
        simulation.at(1.0, lambda: client.call_async(Empty.Request()))

    result = carry_out("service echo /s", introspected, interrupt_at=2.0)
    assert result.out.startswith("info:\n  event_type: REQUEST_RECEIVED\n")
    assert result.out.count("---\n") == 2
    assert (result.err, result.status) == ("", 2)


def test_echo_says_that_nobody_tells_of_calls() -> None:
    result = carry_out("service echo /reset_world", dummy_server, interrupt_at=1.0)
    assert result.err.startswith("WARNING: nobody tells of calls of '/reset_world' yet")


@pytest.mark.parametrize(
    ("line", "out"),
    [
        ("service type /dummy_server_srv", "std_srvs/srv/SetBool\n"),
        ("service find std_srvs/srv/Empty", "/reset_world\n"),
        ("service find -c std_srvs/srv/Empty", "1\n"),
        ("service info /reset_world", "Type: std_srvs/srv/Empty\nClients count: 0\nServices count: 1\n"),
        ("service list -c", "9\n"),
    ],
)
def test_what_is_known_of_services(line: str, out: str) -> None:
    assert carry_out(line, dummy_server).out == out


def test_services_are_listed_by_name_with_their_types() -> None:
    lines = carry_out("service list -t", dummy_server).out.splitlines()
    assert lines == sorted(lines)
    assert "/dummy_server_srv [std_srvs/srv/SetBool]" in lines
    assert "/service_start_turn/get_parameters [rcl_interfaces/srv/GetParameters]" in lines

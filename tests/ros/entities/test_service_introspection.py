"""What a service and its client tell of their calls on a topic of their own."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.entities.service_introspection import ServiceIntrospectionState
from sim.ros.node.node import Node
from sim.ros.qos.qos import qos_profile_system_default
from tests.support.simulation import Simulation, simulate

SetBool = service("std_srvs", "SetBool")
ServiceEventInfo: Any = message("service_msgs", "ServiceEventInfo")

STEPS = [
    ServiceEventInfo.REQUEST_SENT,
    ServiceEventInfo.REQUEST_RECEIVED,
    ServiceEventInfo.RESPONSE_SENT,
    ServiceEventInfo.RESPONSE_RECEIVED,
]


def told(*states: ServiceIntrospectionState) -> list[Any]:
    """The events of one call per state, between which client and service are configured."""
    heard: list[Any] = []

    def serve(_request: Any, response: Any) -> Any:
        response.message = "served"
        return response

    def program(_: Simulation) -> None:
        node = Node("n")
        server = node.create_service(SetBool, "s", serve)
        client = node.create_client(SetBool, "s")
        node.create_subscription(SetBool.Event, "/s/_service_event", heard.append, 10)
        for state in states:
            for each in (client, server):
                each.configure_introspection(node.get_clock(), qos_profile_system_default, state)
            call = client.call_async(SetBool.Request(data=True))
            rclpy.spin_until_future_complete(node, call)
            for _each in range(8):
                rclpy.spin_once(node, timeout_sec=0.0)

    simulate(program)
    return heard


def test_nothing_is_told_of_a_service_that_nobody_watches() -> None:
    assert told(ServiceIntrospectionState.OFF) == []


def test_the_four_steps_of_a_call_are_told_in_order() -> None:
    events = told(ServiceIntrospectionState.METADATA)
    assert [each.info.event_type for each in events] == STEPS
    assert len({bytes(each.info.client_gid) for each in events}) == 1
    assert len({each.info.sequence_number for each in events}) == 1
    assert not any(each.request or each.response for each in events)


def test_the_id_of_a_client_is_the_same_in_every_run_alike() -> None:
    first, second = (
        [bytes(each.info.client_gid) for each in told(ServiceIntrospectionState.METADATA)] for _ in range(2)
    )
    assert first == second
    assert len(first[0]) == 16


def test_contents_come_with_the_steps_if_wanted() -> None:
    events = told(ServiceIntrospectionState.CONTENTS)
    request, response = SetBool.Request(data=True), SetBool.Response(message="served")
    assert [(each.request, each.response) for each in events] == [
        ([request], []),
        ([request], []),
        ([], [response]),
        ([], [response]),
    ]


def test_two_calls_have_two_numbers() -> None:
    events = told(ServiceIntrospectionState.METADATA, ServiceIntrospectionState.METADATA)
    assert len({each.info.sequence_number for each in events}) == 2


def test_the_topic_is_there_while_the_service_is_watched() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        server = node.create_service(SetBool, "s", lambda _, response: response)

        def configure(state: ServiceIntrospectionState) -> None:
            server.configure_introspection(node.get_clock(), qos_profile_system_default, state)

        assert node.count_publishers("/s/_service_event") == 0
        configure(ServiceIntrospectionState.METADATA)
        configure(ServiceIntrospectionState.CONTENTS)
        assert node.count_publishers("/s/_service_event") == 1
        assert ("/s/_service_event", ["std_srvs/srv/SetBool_Event"]) in node.get_topic_names_and_types()
        configure(ServiceIntrospectionState.OFF)
        assert node.count_publishers("/s/_service_event") == 0
        configure(ServiceIntrospectionState.METADATA)
        node.destroy_service(server)
        assert node.count_publishers("/s/_service_event") == 0

    simulate(program)


def test_a_state_that_is_none_is_refused() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "s")
        with pytest.raises(ValueError, match="7"):
            client.configure_introspection(node.get_clock(), qos_profile_system_default, 7)  # type: ignore[arg-type]

    simulate(program)

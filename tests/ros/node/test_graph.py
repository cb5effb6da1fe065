"""The graph: which nodes there are, and which topics and services they have."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import message, service
from sim.ros.entities.topic_endpoint_info import TopicEndpointInfo, TopicEndpointTypeEnum
from sim.ros.exceptions import InvalidTopicNameException, NodeNameNonExistentError
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSPresetProfiles, QoSProfile
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")
String = message("std_msgs", "String")
SetBool = service("std_srvs", "SetBool")


def with_graph(check: Callable[[Node, Node], object]) -> None:
    """Run ``check`` on a talker in /a, with a publisher and a client, and a listener with their others."""

    def program(_: Simulation) -> None:
        talker = Node("talker", namespace="/a", start_parameter_services=False)
        listener = Node("listener", start_parameter_services=False)
        talker.create_publisher(Int32, "t", QoSProfile(depth=3))
        talker.create_client(SetBool, "/s")
        listener.create_subscription(Int32, "/a/t", lambda _: None, 10)
        listener.create_service(SetBool, "s", lambda _, response: response)
        check(talker, listener)

    simulate(program)


def test_every_node_is_named_until_it_is_destroyed() -> None:
    def check(talker: Node, listener: Node) -> None:
        assert listener.get_node_names() == ["talker", "listener"]
        assert listener.get_node_names_and_namespaces() == [("talker", "/a"), ("listener", "/")]
        assert ("talker", "/a", "/") in talker.get_node_names_and_namespaces_with_enclaves()
        assert listener.get_fully_qualified_node_names() == ["/a/talker", "/listener"]
        talker.destroy_node()
        assert listener.get_node_names() == ["listener"]

    with_graph(check)


def test_topics_and_services_are_listed_by_name_with_their_types() -> None:
    def check(talker: Node, listener: Node) -> None:
        topics = dict(talker.get_topic_names_and_types())
        assert topics["/a/t"] == ["std_msgs/msg/Int32"]
        assert topics["/parameter_events"] == ["rcl_interfaces/msg/ParameterEvent"]
        talker.create_publisher(String, "t", 1)
        assert dict(listener.get_topic_names_and_types())["/a/t"] == [
            "std_msgs/msg/Int32",
            "std_msgs/msg/String",
        ]
        assert dict(talker.get_service_names_and_types())["/s"] == ["std_srvs/srv/SetBool"]

    with_graph(check)


def test_a_node_is_asked_for_by_name_and_namespace() -> None:
    def check(talker: Node, listener: Node) -> None:
        topic, srv = ("/a/t", ["std_msgs/msg/Int32"]), ("/s", ["std_srvs/srv/SetBool"])
        assert topic in talker.get_publisher_names_and_types_by_node("talker", "/a")
        assert talker.get_subscriber_names_and_types_by_node("listener", "/") == [topic]
        assert srv in talker.get_service_names_and_types_by_node("listener", "/")
        assert talker.get_client_names_and_types_by_node("talker", "/a") == [srv]
        with pytest.raises(NodeNameNonExistentError, match="'nobody' in namespace '/'"):
            talker.get_client_names_and_types_by_node("nobody", "/")

    with_graph(check)


def test_ends_are_counted_by_a_name_as_the_node_means_it() -> None:
    def check(talker: Node, listener: Node) -> None:
        assert (talker.count_publishers("t"), listener.count_publishers("t")) == (1, 0)
        assert (talker.count_subscribers("t"), listener.count_subscribers("/a/t")) == (1, 1)
        assert (talker.count_services("/s"), talker.count_clients("/s"), talker.count_clients("s")) == (
            1,
            1,
            0,
        )
        with pytest.raises(ValueError, match="topic name is invalid"):
            talker.count_publishers("t?")
        with pytest.raises(InvalidTopicNameException):
            talker.count_publishers("a//b")

    with_graph(check)


def test_the_id_of_an_end_is_the_same_in_every_run_alike() -> None:
    found: list[list[int]] = []

    def check(talker: Node, listener: Node) -> None:
        found.extend(each.endpoint_gid for each in listener.get_publishers_info_by_topic("/a/t"))

    with_graph(check)
    with_graph(check)
    first, second = found
    assert first == second
    assert len(first) == 16


def test_the_ends_of_a_topic_are_described() -> None:
    def check(talker: Node, listener: Node) -> None:
        (publisher,) = listener.get_publishers_info_by_topic("/a/t")
        assert (publisher.node_name, publisher.node_namespace) == ("talker", "/a")
        assert publisher.endpoint_type is TopicEndpointTypeEnum.PUBLISHER
        assert publisher.qos_profile.depth == 3
        assert "  Lifespan: Infinite\n  Deadline: Infinite\n  Liveliness: AUTOMATIC\n" in str(publisher)
        (subscription,) = talker.get_subscriptions_info_by_topic("t")
        assert subscription.endpoint_type.name == "SUBSCRIPTION"
        assert subscription.endpoint_gid != publisher.endpoint_gid
        assert str(publisher).splitlines()[:5] == [
            "Node name: talker",
            "Node namespace: /a",
            "Topic type: std_msgs/msg/Int32",
            "Topic type hash: RIHS01_b6578ded3c58c626cfe8d1a6fb6e04f706f97e9f03d2727c9ff4e74b1cef0deb",
            "Endpoint type: PUBLISHER",
        ]
        assert "  History (Depth): KEEP_LAST (3)" in str(publisher)

    with_graph(check)


def test_a_node_is_waited_for() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        simulation.at(1.0, lambda: Node("late"))
        assert not node.wait_for_node("/late", 0.5)
        assert node.wait_for_node("late", 5.0)
        assert 1.0 <= simulation.now <= 1.2

    simulate(program)


def test_a_description_of_an_end_begins_empty_and_takes_settings_of_its_parts() -> None:
    info = TopicEndpointInfo()
    assert (info.node_name, info.node_namespace, info.topic_type, info.endpoint_gid) == ("", "", "", [])
    assert info.endpoint_type is TopicEndpointTypeEnum.INVALID
    assert info.qos_profile == QoSPresetProfiles.UNKNOWN.value
    assert str(info.topic_type_hash) == "INVALID"
    info.qos_profile = {"depth": 3}  # type: ignore[assignment]
    info.topic_type_hash = {"version": 1, "value": bytes(32)}  # type: ignore[assignment]
    info.endpoint_type = 1  # type: ignore[assignment]
    assert info.qos_profile == QoSProfile(depth=3)
    assert str(info.topic_type_hash) == f"RIHS01_{'0' * 64}"
    assert info.endpoint_type is TopicEndpointTypeEnum.PUBLISHER
    assert info == TopicEndpointInfo(
        qos_profile=QoSProfile(depth=3), topic_type_hash=info.topic_type_hash, endpoint_type=1
    )


@pytest.mark.parametrize(
    "wrong",
    [
        {"node_name": 1},
        {"node_namespace": None},
        {"topic_type": b"x"},
        {"topic_type_hash": "x"},
        {"endpoint_type": "x"},
        {"endpoint_gid": "x"},
        {"qos_profile": 1},
        {"what": 1},
    ],
)
def test_a_description_of_an_end_refuses_wrong_values(wrong: dict[str, Any]) -> None:
    with pytest.raises(AssertionError):
        TopicEndpointInfo(**wrong)


@pytest.mark.parametrize("question", ["count_publishers", "count_services", "get_publishers_info_by_topic"])
def test_a_question_about_what_is_no_name_is_refused(question: str) -> None:
    def check(_talker: Node, listener: Node) -> None:
        with pytest.raises(TypeError, match="a name must be a str"):
            getattr(listener, question)(1)
        with pytest.raises(ValueError, match="is invalid"):
            getattr(listener, question)("42")

    with_graph(check)

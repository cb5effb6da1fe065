"""Hashes and descriptions of message types, and the service by which a node gives them out."""

from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

import sim.ros.rclpy as rclpy
from sim.interfaces import message, service
from sim.ros.middleware.type_description import contained_types, type_description, type_hash
from sim.ros.node.node import Node
from tests.support.simulation import Simulation, simulate

GetTypeDescription = service("type_description_interfaces", "GetTypeDescription")
Twist: Any = message("geometry_msgs", "Twist")
TWIST_TYPES = ["geometry_msgs/msg/Twist", "geometry_msgs/msg/Vector3"]


def test_the_hash_of_a_string_is_the_one_that_ros2_tells() -> None:
    known = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
    assert str(type_hash(message("std_msgs", "String"))) == known


@pytest.mark.parametrize(
    ("package", "name"),
    [
        ("sensor_msgs", "LaserScan"),
        ("nav_msgs", "Odometry"),
        ("std_msgs", "Empty"),
        ("rcl_interfaces", "ParameterDescriptor"),
        ("shape_msgs", "SolidPrimitive"),
    ],
)
def test_hashes_agree_with_those_of_rosbags(package: str, name: str) -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    assert str(type_hash(message(package, name))) == store.hash_rihs01(f"{package}/msg/{name}")


def test_a_description_names_every_field_and_every_type_within() -> None:
    description = type_description(Twist)
    own = description.type_description
    assert [own.type_name, *(each.type_name for each in description.referenced_type_descriptions)] == (
        TWIST_TYPES
    )
    assert [(each.name, each.type.nested_type_name) for each in own.fields] == [
        ("linear", TWIST_TYPES[1]),
        ("angular", TWIST_TYPES[1]),
    ]
    assert [each.__type_name__ for each in contained_types(Twist)] == TWIST_TYPES[1:]


def described(type_hash: str) -> Any:
    """What a node that publishes a Twist answers."""
    answers: list[Any] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Twist, "t", 1)
        client = node.create_client(GetTypeDescription, "/n/get_type_description")
        future = client.call_async(GetTypeDescription.Request(type_hash=type_hash))
        rclpy.spin_until_future_complete(node, future)
        answers.append(future.result())

    simulate(program)
    return answers[0]


def test_a_node_describes_the_types_it_uses_with_their_sources() -> None:
    answer = described(str(type_hash(Twist)))
    assert answer.successful
    assert answer.type_description == type_description(Twist)
    assert [(each.type_name, each.encoding) for each in answer.type_sources] == [
        (each, "msg") for each in TWIST_TYPES
    ]
    assert "float64 x" in answer.type_sources[1].raw_file_contents


@pytest.mark.parametrize(
    ("wanted", "reason"),
    [
        ("", "Failed to parse type hash"),
        (str(type_hash(message("std_msgs", "Int8"))), "Type not currently in use by this node"),
    ],
)
def test_a_node_tells_why_it_does_not_describe_a_type(wanted: str, reason: str) -> None:
    answer = described(wanted)
    assert not answer.successful
    assert answer.failure_reason == reason


def test_the_graph_tells_the_hash_of_a_topics_type() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_publisher(Twist, "t", 1)
        (info,) = node.get_publishers_info_by_topic("t")
        assert info.topic_type_hash == type_hash(Twist)

    simulate(program)

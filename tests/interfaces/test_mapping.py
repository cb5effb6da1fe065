"""Filling messages from plain values."""

from __future__ import annotations

from typing import Any

import pytest

from sim.ros.interfaces import MappingError, Message, message, message_from_mapping, service

Twist = message("geometry_msgs", "Twist")
Vector3 = message("geometry_msgs", "Vector3")
Marker = message("visualization_msgs", "Marker")


def test_given_fields_are_set_and_others_keep_their_defaults() -> None:
    filled = message_from_mapping(Twist, {"linear": {"x": 0.5}, "angular": {"z": -1.0}})
    assert filled == Twist(linear=Vector3(x=0.5), angular=Vector3(z=-1.0))
    assert message_from_mapping(message("geometry_msgs", "Pose"), {}).orientation.w == 1.0


def test_integers_pass_for_floats() -> None:
    assert repr(message_from_mapping(Vector3, {"x": 2}).x) == "2.0"
    scan = message_from_mapping(message("sensor_msgs", "LaserScan"), {"ranges": [1, 2.5]})
    assert scan.ranges.tolist() == [1.0, 2.5]


def test_lists_of_messages_are_filled_one_by_one() -> None:
    marker = message_from_mapping(Marker, {"points": [{"x": 1}, {}], "colors": []})
    assert [point.x for point in marker.points] == [1.0, 0.0]


def test_requests_are_filled_too() -> None:
    assert message_from_mapping(service("std_srvs", "SetBool").Request, {"data": True}).data is True
    assert message_from_mapping(service("std_srvs", "SetBool").Request, {"data": 1}).data is True


@pytest.mark.parametrize(
    ("name", "given", "stored"),
    [("String", 5, "5"), ("Byte", 7, b"\x07"), ("Char", 97, 97), ("Bool", 0, False), ("Float32", 1, 1.0)],
)
def test_plain_values_become_the_fields_kind(name: str, given: object, stored: object) -> None:
    assert message_from_mapping(message("std_msgs", name), {"data": given}).data == stored


def test_fixed_arrays_take_lists_of_the_right_length() -> None:
    pose = message("geometry_msgs", "PoseWithCovariance")
    assert message_from_mapping(pose, {"covariance": [1] * 36}).covariance.sum() == 36.0
    with pytest.raises(MappingError, match=r"^covariance: The 'covariance' field must be .* with length 36 "):
        message_from_mapping(pose, {"covariance": [1]})


@pytest.mark.parametrize(
    ("name", "mapping", "text"),
    [
        ("Int8", {"data": 300}, "data: The 'data' field must be an integer in [-128, 127]"),
        ("Int8", {"data": 1.0}, "data: an integer is wanted, not 1.0"),
        ("Bool", {"data": "yes"}, "data: true or false is wanted, not 'yes'"),
        ("Byte", {"data": 256}, "data: an integer from 0 to 255 is wanted, not 256"),
        ("String", {"data": []}, "data: a text is wanted, not []"),
        ("Empty", {"data": 1}, "std_msgs/msg/Empty has no field 'data'; it has no fields"),
    ],
)
def test_a_value_that_does_not_fit_is_named(name: str, mapping: dict[str, object], text: str) -> None:
    assert mistake(message("std_msgs", name), mapping) == text


def test_an_unknown_field_names_the_known_ones() -> None:
    assert mistake(Twist, {"liner": {}}) == (
        "geometry_msgs/msg/Twist has no field 'liner'; its fields are linear, angular"
    )
    assert mistake(Twist, {"linear": {"q": 1}}) == (
        "linear: geometry_msgs/msg/Vector3 has no field 'q'; its fields are x, y, z"
    )


def test_a_mistake_inside_is_named_with_its_place() -> None:
    assert mistake(Twist, {"linear": {"y": "a"}}) == "linear.y: a number is wanted, not 'a'"
    assert mistake(Twist, {"linear": {"y": True}}) == "linear.y: a number is wanted, not True"
    assert mistake(Marker, {"points": [{}, {"x": None}]}) == "points[1].x: a number is wanted, not None"


def test_a_value_of_the_wrong_shape_is_told_the_right_one() -> None:
    assert mistake(Twist, [1]) == "geometry_msgs/msg/Twist is written as {field: value, …}, not as [1]"
    assert mistake(Twist, {"linear": 3}) == (
        "linear: geometry_msgs/msg/Vector3 is written as {field: value, …}, not as 3"
    )
    assert mistake(Marker, {"points": {"x": 1}}) == (
        "points: sequence<geometry_msgs/Point> is written as [value, …], not as {'x': 1}"
    )


def mistake(cls: type[Message], mapping: Any) -> str:
    with pytest.raises(MappingError) as wrong:
        message_from_mapping(cls, mapping)
    return str(wrong.value)

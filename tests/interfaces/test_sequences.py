"""What fields with several values take and how they keep them."""

from __future__ import annotations

import math
from array import array
from collections import UserList
from typing import Any

import numpy as np
import pytest

from sim.interfaces import message

LaserScan = message("sensor_msgs", "LaserScan")
Bytes = message("std_msgs", "UInt8MultiArray")
Pose = message("geometry_msgs", "PoseWithCovariance")
Point = message("geometry_msgs", "Point")
Polygon = message("visualization_msgs", "Marker")
Solid = message("shape_msgs", "SolidPrimitive")
Parameter = message("rcl_interfaces", "ParameterValue")
Uuid = message("unique_identifier_msgs", "UUID")
Integers = message("std_msgs", "Int16MultiArray")

DOUBLE_LIMIT = f"{1.7976931348623157e308:f}"


def refusal(cls: Any, **values: object) -> str:
    with pytest.raises(AssertionError) as refused:
        cls(**values)
    return str(refused.value)


@pytest.mark.parametrize(
    "values",
    [
        [0.5, 2.0],
        (0.5, 2.0),
        UserList([0.5, 2.0]),
        array("f", [0.5, 2.0]),
        np.array([0.5, 2.0]),
        np.array([0.5, 2.0], np.float32),
        np.array([0.5, 9.0, 2.0])[::2],
    ],
)
def test_a_float_sequence_becomes_an_array_of_its_width(values: Any) -> None:
    assert LaserScan(ranges=values).ranges == array("f", [0.5, 2.0])


def test_a_set_of_numbers_is_taken() -> None:
    assert LaserScan(ranges={1.5}).ranges == array("f", [1.5])


def test_bytes_are_numbers_one_by_one() -> None:
    assert Bytes(data=b"\x01\xff").data == array("B", [1, 255])
    assert Integers(data=b"\x01\xff").data == array("h", [1, 255])


def test_an_array_of_the_right_type_is_kept_not_copied() -> None:
    ranges, covariance = array("f", [1.0]), np.zeros(36)
    assert LaserScan(ranges=ranges).ranges is ranges
    assert Pose(covariance=covariance).covariance is covariance


@pytest.mark.parametrize(
    "values",
    [[1, 2], [1.0, 2], "12", None, 3.0, {1.0: 2}, iter([1.0]), [[1.0]], [3.5e38], [math.inf, -1e300], [None],
     np.array([1, 2]), np.array([[1.0]]), np.array([1e39]), np.array(["a"])],
)  # fmt: skip
def test_anything_else_is_no_float_sequence(values: object) -> None:
    bound = "340282346600000016151267322115014000640.000000"
    assert refusal(LaserScan, ranges=values) == (
        "The 'ranges' field must be a set or sequence and each value of type 'float' "
        f"and each float in [-{bound}, {bound}]"
    )


@pytest.mark.parametrize(
    "values", [[math.inf, 1.0], [math.nan, 3.402823466e38], np.array([math.nan, -math.inf])]
)
def test_infinities_and_nan_are_floats(values: Any) -> None:
    assert list(map(repr, LaserScan(ranges=values).ranges)) == [repr(float(np.float32(v))) for v in values]


@pytest.mark.parametrize(
    "values", [[256], [-1], [1.0], ["a"], np.array([256]), np.array([1.0]), np.array([True])]
)
def test_integers_out_of_range_are_refused(values: object) -> None:
    assert refusal(Bytes, data=values) == (
        "The 'data' field must be a set or sequence and each value of type 'int' "
        "and each unsigned integer in [0, 255]"
    )


def test_signed_integers_name_their_own_range() -> None:
    assert refusal(Integers, data=[40000]).endswith(
        "each value of type 'int' and each integer in [-32768, 32767]"
    )


def test_an_array_of_another_type_code_is_refused() -> None:
    text = "The 'ranges' array.array() must have the type code of 'f'"
    assert refusal(LaserScan, ranges=array("d", [1.0])) == text


def test_a_bounded_sequence_refuses_one_too_many() -> None:
    assert Solid(dimensions=[1.0, 2.0, 3.0]).dimensions == array("d", [1.0, 2.0, 3.0])
    assert refusal(Solid, dimensions=[0.0] * 4) == (
        "The 'dimensions' field must be a set or sequence with length <= 3 and each value of type 'float' "
        f"and each double in [-{DOUBLE_LIMIT}, {DOUBLE_LIMIT}]"
    )
    assert refusal(Solid, dimensions=array("d", [0.0] * 4)) == (
        "The 'dimensions' array.array() must have a size <= 3"
    )
    assert "with length <= 3" in refusal(Solid, dimensions=np.zeros(4))


def test_a_fixed_count_of_numbers_is_a_numpy_array() -> None:
    covariance = Pose(covariance=[float(n) for n in range(36)]).covariance
    assert isinstance(covariance, np.ndarray)
    assert covariance.dtype == np.float64
    assert covariance.tolist() == list(range(36))


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (np.zeros(35), "The 'covariance' numpy.ndarray() must have a size of 36"),
        (np.zeros(36, np.float32), "The 'covariance' numpy.ndarray() must have the dtype of 'numpy.float64'"),
        (
            [0.0] * 35,
            "The 'covariance' field must be a set or sequence with length 36 and each value of type 'float' "
            f"and each double in [-{DOUBLE_LIMIT}, {DOUBLE_LIMIT}]",
        ),
    ],
)
def test_a_fixed_count_of_numbers_refuses_others(values: object, text: str) -> None:
    assert refusal(Pose, covariance=values) == text


def test_sixteen_bytes_make_a_uuid() -> None:
    assert Uuid(uuid=bytes(range(16))).uuid.tolist() == list(range(16))
    assert "with length 16 " in refusal(Uuid, uuid=b"short")


def test_texts_truth_values_and_bytes_stay_in_their_list() -> None:
    value = Parameter(string_array_value=["a"], bool_array_value=(True, False), byte_array_value=[b"\x07"])
    assert value.string_array_value == ["a"]
    assert value.bool_array_value == (True, False)
    assert value.byte_array_value == [b"\x07"]


@pytest.mark.parametrize(
    ("field", "values", "name"),
    [
        ("string_array_value", ["a", 1], "str"),
        ("string_array_value", "ab", "str"),
        ("bool_array_value", [1], "bool"),
        ("byte_array_value", [7], "bytes"),
        ("byte_array_value", [b"ab"], "bytes"),
    ],
)
def test_lists_name_the_class_they_want(field: str, values: object, name: str) -> None:
    text = f"The '{field}' field must be a set or sequence and each value of type '{name}'"
    assert refusal(Parameter, **{field: values}) == text


def test_a_sequence_of_messages_takes_that_message_only() -> None:
    assert Polygon(points=[Point(x=1.0)]).points == [Point(x=1.0)]
    assert refusal(Polygon, points=[Point(), 3]) == (
        "The 'points' field must be a set or sequence and each value of type 'Point'"
    )

"""What a field with one value takes, and what it says to anything else."""

from __future__ import annotations

import math
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.interfaces import message
from sim.interfaces.field_types import INTEGER_LIMITS

Twist = message("geometry_msgs", "Twist")
Vector3 = message("geometry_msgs", "Vector3")
String = message("std_msgs", "String")
Float32 = message("std_msgs", "Float32")

INTEGER_MESSAGES = {
    name: message("std_msgs", name.replace("uint", "UInt").replace("int", "Int")) for name in INTEGER_LIMITS
}


@given(st.sampled_from(sorted(INTEGER_LIMITS)), st.data())
def test_an_integer_in_range_is_kept(typename: str, data: st.DataObject) -> None:
    value = data.draw(st.integers(*INTEGER_LIMITS[typename]))
    assert INTEGER_MESSAGES[typename](data=value).data == value


@given(st.sampled_from(sorted(INTEGER_LIMITS)), st.integers(min_value=1), st.booleans())
def test_an_integer_out_of_range_is_refused_with_the_range(typename: str, beyond: int, above: bool) -> None:
    low, high = INTEGER_LIMITS[typename]
    noun = "unsigned integer" if typename.startswith("u") else "integer"
    with pytest.raises(AssertionError) as refused:
        INTEGER_MESSAGES[typename]().data = high + beyond if above else low - beyond
    assert str(refused.value) == f"The 'data' field must be an {noun} in [{low}, {high}]"


def test_the_range_of_a_32_bit_integer_reads_as_in_rclpy() -> None:
    with pytest.raises(AssertionError) as refused:
        INTEGER_MESSAGES["int32"](data=2**31)
    assert str(refused.value) == "The 'data' field must be an integer in [-2147483648, 2147483647]"


@pytest.mark.parametrize("value", [1.0, "1", None, np.int32(1), b"\x01"])
def test_an_integer_field_refuses_other_classes(value: object) -> None:
    with pytest.raises(AssertionError, match=r"^The 'data' field must be of type 'int'$"):
        INTEGER_MESSAGES["int32"](data=value)


@pytest.mark.parametrize("value", [1, "a", True, None, np.float32(1), Decimal(1)])
def test_a_float_field_refuses_other_classes(value: object) -> None:
    with pytest.raises(AssertionError, match=r"^The 'x' field must be of type 'float'$"):
        Twist().linear.x = value


@pytest.mark.parametrize("value", [1.5, np.float64(1.5), math.inf, -math.inf, 1.7976931348623157e308])
def test_a_float_field_takes_any_float(value: float) -> None:
    twist = Twist()
    twist.linear.x = value
    assert twist.linear.x == value


@pytest.mark.parametrize("value", [math.inf, -math.inf, 3.402823466e38, -3.402823466e38])
def test_a_32_bit_float_takes_infinities_and_its_own_range(value: float) -> None:
    assert Float32(data=value).data == value


def test_nan_passes_both_kinds_of_float() -> None:
    assert math.isnan(Float32(data=math.nan).data)
    assert math.isnan(Vector3(x=math.nan).x)


@pytest.mark.parametrize("value", [3.5e38, -1e300])
def test_a_32_bit_float_out_of_range_is_refused_with_the_range(value: float) -> None:
    with pytest.raises(AssertionError) as refused:
        Float32(data=value)
    assert str(refused.value) == "The 'data' field must be a float in [-3.402823466e+38, 3.402823466e+38]"


@pytest.mark.parametrize(
    ("cls", "value", "wanted"),
    [
        (String, 5, "of type 'str'"),
        (String, b"text", "of type 'str'"),
        (message("std_msgs", "Bool"), 1, "of type 'bool'"),
        (message("std_msgs", "Byte"), 1, "of type 'bytes' or 'ByteString' with length 1"),
        (message("std_msgs", "Byte"), b"ab", "of type 'bytes' or 'ByteString' with length 1"),
        (message("std_msgs", "Char"), "a", "of type 'int'"),
        (message("std_msgs", "Char"), 256, "an unsigned integer in [0, 255]"),
        (message("example_interfaces", "WString"), 5, "of type 'str'"),
    ],
)
def test_other_fields_say_what_they_want(cls: Any, value: object, wanted: str) -> None:
    with pytest.raises(AssertionError) as refused:
        cls(data=value)
    assert str(refused.value) == f"The 'data' field must be {wanted}"


def test_a_bounded_text_counts_characters() -> None:
    info = message("rmw_dds_common", "NodeEntitiesInfo")
    assert info(node_name="ä" * 256).node_name == "ä" * 256
    with pytest.raises(AssertionError) as refused:
        info(node_name="a" * 257)
    assert str(refused.value) == "The 'node_name' field must be string value not longer than 256"


@pytest.mark.parametrize("value", [None, 3.0, {"x": 1.0}, message("geometry_msgs", "Point")()])
def test_a_sub_message_of_another_class_is_refused(value: object) -> None:
    with pytest.raises(AssertionError) as refused:
        Twist().linear = value
    assert str(refused.value) == "The 'linear' field must be a sub message of type 'Vector3'"


def test_a_refused_value_leaves_the_old_one() -> None:
    vector = Vector3(x=2.0)
    with pytest.raises(AssertionError):
        vector.x = 3
    assert vector.x == 2.0


def test_an_assigned_sub_message_is_shared_not_copied() -> None:
    linear = Vector3()
    twist = Twist(linear=linear)
    linear.x = 4.0
    assert twist.linear.x == 4.0

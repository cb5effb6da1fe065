"""Copies and CDR: what arrives is what was sent."""

from __future__ import annotations

import math
import struct
from array import array
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from rosbags.typesys import Stores, get_typestore

from sim.interfaces import (
    Message,
    action,
    copy_message,
    definition,
    from_cdr,
    message,
    message_of_type,
    service,
    to_cdr,
)
from tests.interfaces.strategies import messages
from tests.support.properties import examples

CLASSES = [
    message("builtin_interfaces", "Time"),
    message("diagnostic_msgs", "DiagnosticArray"),
    message("geometry_msgs", "Twist"),
    message("geometry_msgs", "PoseWithCovariance"),
    message("nav_msgs", "Path"),
    message("rcl_interfaces", "Parameter"),
    message("rcl_interfaces", "ParameterDescriptor"),
    message("rmw_dds_common", "NodeEntitiesInfo"),
    message("sensor_msgs", "JointState"),
    message("sensor_msgs", "LaserScan"),
    message("sensor_msgs", "CameraInfo"),
    message("shape_msgs", "SolidPrimitive"),
    message("std_msgs", "ByteMultiArray"),
    message("std_msgs", "Char"),
    message("std_msgs", "Empty"),
    message("std_msgs", "String"),
    message("std_msgs", "UInt64MultiArray"),
    message("tf2_msgs", "TFMessage"),
    message("example_interfaces", "WString"),
    message("test_msgs", "BasicTypes"),
    message("test_msgs", "Strings"),
    message("test_msgs", "WStrings"),
    service("std_srvs", "SetBool").Response,
    service("rcl_interfaces", "SetParameters").Request,
    service("std_srvs", "SetBool").Event,
    action("test_msgs", "NestedMessage").Impl.FeedbackMessage,
    action("example_interfaces", "Fibonacci").Impl.SendGoalService.Request,
    action("example_interfaces", "Fibonacci").Impl.GetResultService.Response,
]

random_messages = st.sampled_from(CLASSES).flatmap(messages)
# Shrinking large messages takes minutes. The first example builds serialisers, and large
# messages are wanted here.
patient = settings(
    deadline=None,
    max_examples=examples(150),
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
    suppress_health_check=[HealthCheck.data_too_large, HealthCheck.too_slow],
)


@patient
@given(random_messages)
def test_cdr_brings_back_what_went_in(original: Message) -> None:
    received = from_cdr(type(original), to_cdr(original))
    assert received == original
    assert repr(received) == repr(original)


@pytest.mark.parametrize("name", ["Arrays", "BoundedSequences", "UnboundedSequences"])
def test_cdr_brings_back_every_kind_of_sequence_with_its_defaults(name: str) -> None:
    original = message("test_msgs", name)()
    assert repr(from_cdr(type(original), to_cdr(original))) == repr(original)


@patient
@given(random_messages)
def test_a_copy_equals_its_original(original: Message) -> None:
    copied = copy_message(original)
    assert copied == original
    assert repr(copied) == repr(original)
    assert copied is not original


@patient
@given(random_messages)
def test_a_copy_shares_nothing_that_can_change(original: Message) -> None:
    assert not set(map(id, mutable_parts(copy_message(original)))) & set(map(id, mutable_parts(original)))


def mutable_parts(value: Any) -> list[Any]:
    """Return a message and every message, list and array in it."""
    if isinstance(value, Message):
        inner = [
            part
            for name in value.get_fields_and_field_types()
            for part in mutable_parts(getattr(value, name))
        ]
        return [value, *inner]
    if isinstance(value, list):
        return [value, *(part for item in value for part in mutable_parts(item))]
    return [value] if isinstance(value, array | np.ndarray) else []


def test_a_copy_is_what_a_subscriber_would_receive() -> None:
    assert (
        copy_message(message("std_msgs", "Float32")(data=0.1)).data
        == struct.unpack("f", struct.pack("f", 0.1))[0]
    )
    vector = copy_message(message("geometry_msgs", "Vector3")(x=np.float64(0.1)))
    assert type(vector.x) is float
    assert type(copy_message(message("std_msgs", "Int8")(data=True)).data) is int
    path = message("rcl_interfaces", "ParameterValue")(string_array_value=("a", "b"))
    assert copy_message(path).string_array_value == ["a", "b"]


def test_infinities_and_nan_survive_copy_and_wire() -> None:
    scan = message("sensor_msgs", "LaserScan")(
        range_max=math.inf, angle_min=math.nan, ranges=[math.nan, -math.inf]
    )
    for received in (copy_message(scan), from_cdr(type(scan), to_cdr(scan))):
        assert repr(received) == repr(scan)


def test_a_message_of_a_subclass_arrives_as_the_message() -> None:
    class Mine(message("std_msgs", "Int32")):  # type: ignore[misc]
        pass

    assert type(copy_message(Mine(data=4))) is message("std_msgs", "Int32")


def test_cdr_is_little_endian_with_its_header() -> None:
    assert to_cdr(message("std_msgs", "Int32")(data=1)) == b"\x00\x01\x00\x00\x01\x00\x00\x00"
    assert to_cdr(message("std_msgs", "String")(data="ab")) == b"\x00\x01\x00\x00\x03\x00\x00\x00ab\x00"
    assert to_cdr(message("std_msgs", "Byte")(data=b"\xff")) == b"\x00\x01\x00\x00\xff"


def test_big_endian_cdr_is_read_too() -> None:
    data = b"\x00\x00\x00\x00" + struct.pack(">I2i", 2, 7, -7)
    layout = b"\x00\x00\x00\x00\x00\x00\x00\x00"
    received = from_cdr(message("std_msgs", "Int32MultiArray"), data[:4] + layout + data[4:])
    assert received.data == array("i", [7, -7])


@pytest.mark.parametrize("data", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00\xff\xff\x00\x00", b"junkjunk"])
def test_bytes_that_are_no_message_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match=f"^these {len(data)} bytes hold no std_msgs/msg/String: "):
        from_cdr(message("std_msgs", "String"), data)


def test_wide_strings_are_units_in_four_bytes_each() -> None:
    wide = message("example_interfaces", "WString")
    assert to_cdr(wide(data="aö")) == b"\x00\x01\x00\x00" + struct.pack("<3I", 2, 97, 246)
    smile = wide(data="😀")
    assert to_cdr(smile)[4:8] == struct.pack("<I", 2)
    assert from_cdr(wide, to_cdr(smile)) == smile


def test_definitions_read_as_those_of_rosbags() -> None:
    store = get_typestore(Stores.ROS2_JAZZY)
    for name in store.fielddefs:
        assert definition(message_of_type(name)) == store.generate_msgdef(name, ros_version=2)[0]


def test_definitions_of_actions_parts_can_be_written() -> None:
    feedback = action("example_interfaces", "Fibonacci").Impl.FeedbackMessage
    assert definition(feedback).startswith(
        "unique_identifier_msgs/UUID goal_id\nexample_interfaces/Fibonacci_Feedback feedback\n"
    )


def test_a_definition_lists_constants_fields_and_what_they_contain() -> None:
    text = definition(message("geometry_msgs", "Twist"))
    assert text == (
        "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"
        f"{'=' * 80}\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n"
    )
    assert "uint8 FLOAT32=7\n" in definition(message("sensor_msgs", "PointField"))
    assert definition(service("std_srvs", "SetBool").Request) == "bool data\n"

"""What is written is what rosbags' serialiser writes, byte for byte."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from sim.interfaces import Message, action, from_cdr, message, names, service, to_cdr
from sim.interfaces.cdr import typestore_of
from sim.interfaces.field_types import AbstractWString, BasicType, FieldType, SequenceType, element_type
from sim.interfaces.interface_definition import FILLER_FIELD
from sim.interfaces.sequences import typecode
from tests.interfaces.strategies import TEXT, messages
from tests.support.properties import examples

PACKAGES = ("std_msgs", "geometry_msgs", "nav_msgs", "sensor_msgs", "test_msgs")

CLASSES = [
    *(message(package, name) for package in PACKAGES for name in names(package, "msg")),
    message("builtin_interfaces", "Time"),
    message("diagnostic_msgs", "DiagnosticArray"),
    message("rcl_interfaces", "Log"),
    message("rcl_interfaces", "ParameterEvent"),
    message("rmw_dds_common", "NodeEntitiesInfo"),
    message("tf2_msgs", "TFMessage"),
    message("visualization_msgs", "Marker"),
    message("example_interfaces", "WString"),
    service("std_srvs", "Empty").Request,
    service("std_srvs", "SetBool").Event,
    action("test_msgs", "NestedMessage").Impl.FeedbackMessage,
    action("example_interfaces", "Fibonacci").Impl.GetResultService.Response,
]

# The first message of a class makes encoders; shrinking large messages takes minutes.
patient = settings(
    deadline=None,
    max_examples=examples(6),
    phases=[Phase.explicit, Phase.reuse, Phase.generate],
    suppress_health_check=[HealthCheck.data_too_large, HealthCheck.too_slow],
)


@pytest.mark.filterwarnings("ignore:Generating overly large repr")
@pytest.mark.parametrize("cls", CLASSES, ids=lambda cls: cls.__type_name__)
def test_messages_are_the_bytes_that_rosbags_writes(cls: type[Message]) -> None:
    @patient
    @given(messages(cls))
    def check(original: Message) -> None:
        assert to_cdr(original) == rosbags_cdr(original)

    check()
    assert to_cdr(cls()) == rosbags_cdr(cls())


def rosbags_cdr(original: Message) -> bytes:
    store = typestore_of(type(original))
    return bytes(store.serialize_cdr(as_rosbags_has_it(original), original.__type_name__))


def as_rosbags_has_it(original: Message) -> SimpleNamespace:
    """A message with the values that rosbags takes: numpy arrays for all sequences of numbers."""
    types = original.__interface__.types.items()
    values = {name: _converted(of, getattr(original, name)) for name, of in types}
    return SimpleNamespace(**(values or {FILLER_FIELD: 0}))


def _converted(of: FieldType, value: Any) -> Any:
    if not isinstance(of, SequenceType):
        return _element(of, value)
    if typecode(of) is not None:
        return np.asarray(value)
    element = element_type(of)
    if element == BasicType("boolean"):
        return np.array(value, np.bool_)
    if element == BasicType("octet"):
        return np.array(list(b"".join(value)), np.uint8)
    return [_element(element, each) for each in value]


def _element(of: FieldType, value: Any) -> Any:
    if isinstance(value, Message):
        return as_rosbags_has_it(value)
    if isinstance(of, AbstractWString):
        units = np.frombuffer(value.encode("utf-16-le", "surrogatepass"), "<u2")
        return SimpleNamespace(units=units.astype(np.uint32))
    return struct.unpack("b", value)[0] if of == BasicType("octet") else value


@given(TEXT, st.booleans())
def test_a_message_of_a_subclass_is_written_as_its_message(text: str, success: bool) -> None:
    response = service("std_srvs", "SetBool").Response

    class Mine(response):  # type: ignore[misc, valid-type]
        remark = "not on the wire"

    assert to_cdr(Mine(message=text, success=success)) == to_cdr(response(message=text, success=success))


def test_bytes_may_be_a_bytearray() -> None:
    byte = message("std_msgs", "Byte")
    assert to_cdr(byte(data=bytearray(b"\x07"))) == to_cdr(byte(data=b"\x07"))


def test_a_numpy_array_may_be_a_view_with_gaps() -> None:
    covariance = np.arange(72.0)[::2]
    pose = message("geometry_msgs", "PoseWithCovariance")(covariance=covariance)
    assert np.array_equal(from_cdr(type(pose), to_cdr(pose)).covariance, covariance)


def test_a_list_of_fixed_length_that_was_shortened_since_is_refused() -> None:
    arrays = message("test_msgs", "Arrays")()
    arrays.string_values.pop()
    with pytest.raises(ValueError, match=r"^the field 'string_values' holds 2 values and must hold 3$"):
        to_cdr(arrays)

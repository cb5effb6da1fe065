"""Messages as bytes, and what is no message type at all."""

import pytest

from sim.interfaces import message, service
from sim.ros.entities.serialization import deserialize_message, serialize_message
from sim.ros.entities.type_support import check_is_valid_msg_type, check_is_valid_srv_type

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def test_a_message_survives_the_journey_as_bytes() -> None:
    data = serialize_message(Int32(data=-2))
    assert data == b"\x00\x01\x00\x00\xfe\xff\xff\xff"
    assert deserialize_message(data, Int32) == Int32(data=-2)


def test_bytes_that_hold_no_such_message_are_refused() -> None:
    with pytest.raises(ValueError, match="hold no std_msgs/msg/Int32"):
        deserialize_message(b"\x00\x01\x00\x00", Int32)


def test_a_service_is_no_message_and_a_message_no_service() -> None:
    check_is_valid_msg_type(Int32)
    check_is_valid_srv_type(SetBool)
    with pytest.raises(RuntimeError, match=r"^The message type provided is not valid .*a service or action$"):
        check_is_valid_msg_type(SetBool)
    with pytest.raises(RuntimeError, match=r"^The service type provided is not valid .*a message or action$"):
        check_is_valid_srv_type(Int32)


def test_what_comes_from_no_definition_has_no_type_support() -> None:
    for check in (check_is_valid_msg_type, check_is_valid_srv_type):
        with pytest.raises(AttributeError, match=r"^type object 'type' has no attribute '_TYPE_SUPPORT'"):
            check(int)

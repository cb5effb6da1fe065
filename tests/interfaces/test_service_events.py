"""The messages that tell of a step of a service's call."""

import pickle
from typing import Any

import pytest

from sim.interfaces import copy_message, message_of_type, service, type_name

SetBool = service("std_srvs", "SetBool")


def test_a_service_has_a_message_for_its_events() -> None:
    event: Any = SetBool.Event
    assert type_name(event) == "std_srvs/srv/SetBool_Event"
    assert event.get_fields_and_field_types() == {
        "info": "service_msgs/ServiceEventInfo",
        "request": "sequence<std_srvs/SetBool_Request, 1>",
        "response": "sequence<std_srvs/SetBool_Response, 1>",
    }
    assert message_of_type("std_srvs/srv/SetBool_Event") is event
    assert event.__module__ == "std_srvs.srv._set_bool"


def test_an_event_holds_at_most_one_request() -> None:
    event = SetBool.Event(request=[SetBool.Request(data=True)])
    assert copy_message(event) == pickle.loads(pickle.dumps(event)) == event
    with pytest.raises(AssertionError):
        SetBool.Event(request=[SetBool.Request(), SetBool.Request()])

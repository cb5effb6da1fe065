"""The message that reports one step of a service call: ``std_srvs/srv/SetBool_Event`` for SetBool."""

from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc

from sim.interfaces.base import Message, ServiceType
from sim.interfaces.interface_definition import Definition


def event_definition(service: ServiceType) -> Definition:
    """Return the event that rosidl adds to a service: the step, and at most one request and one response."""

    def at_most_one(part: type[Message]) -> FieldDesc:
        return Nodetype.SEQUENCE, ((Nodetype.NAME, part.__type_name__), 1)

    fields: list[tuple[str, FieldDesc]] = [
        ("info", (Nodetype.NAME, "service_msgs/msg/ServiceEventInfo")),
        ("request", at_most_one(service.Request)),
        ("response", at_most_one(service.Response)),
    ]
    request = service.Request.__interface__.definition
    return Definition(request.package, request.kind, f"{service.__name__}_Event", [], fields)

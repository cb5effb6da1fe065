"""The names that programs import from rclpy's compiled part."""

from sim.ros.clocks.clock import ClockEvent
from sim.ros.entities.entity_handles import RequestId as rmw_request_id_t  # noqa: N813 -- rclpy's own name
from sim.ros.entities.entity_handles import ServiceInfo as rmw_service_info_t  # noqa: N813 -- rclpy's own name
from sim.ros.entities.event_handler import UnsupportedEventTypeError
from sim.ros.entities.guard_condition import BareGuardCondition as GuardCondition
from sim.ros.exceptions import (
    InvalidHandle,
    NodeNameNonExistentError,
    RCLError,
    RCLInvalidROSArgsError,
    UnknownROSArgsError,
)
from sim.ros.internals.bare_entities import BareClient as Client
from sim.ros.internals.bare_entities import BareService as Service
from sim.ros.internals.bare_entities import BareSubscription as Subscription
from sim.ros.internals.bare_entities import BareTimer as Timer
from sim.ros.internals.bare_events import event_handle as EventHandle  # noqa: N812 -- a class in rclpy
from sim.ros.internals.bare_wait_set import BareWaitSet as WaitSet

__all__ = [
    "Client",
    "ClockEvent",
    "EventHandle",
    "GuardCondition",
    "InvalidHandle",
    "NodeNameNonExistentError",
    "RCLError",
    "RCLInvalidROSArgsError",
    "Service",
    "Subscription",
    "Timer",
    "UnknownROSArgsError",
    "UnsupportedEventTypeError",
    "WaitSet",
    "rmw_request_id_t",
    "rmw_service_info_t",
]

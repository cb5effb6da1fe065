"""What programs import from rclpy's compiled part."""

from sim.ros.bare_entities import BareClient as Client
from sim.ros.bare_entities import BareGuardCondition as GuardCondition
from sim.ros.bare_entities import BareService as Service
from sim.ros.bare_entities import BareSubscription as Subscription
from sim.ros.bare_entities import BareTimer as Timer
from sim.ros.clock import ClockEvent
from sim.ros.exceptions import (
    InvalidHandle,
    NodeNameNonExistentError,
    RCLError,
    RCLInvalidROSArgsError,
    UnknownROSArgsError,
)

__all__ = [
    "Client",
    "ClockEvent",
    "GuardCondition",
    "InvalidHandle",
    "NodeNameNonExistentError",
    "RCLError",
    "RCLInvalidROSArgsError",
    "Service",
    "Subscription",
    "Timer",
    "UnknownROSArgsError",
]

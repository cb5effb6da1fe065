"""The former name of ``rclpy.event_handler``, and of the event handler itself."""

import warnings

from sim.ros.entities.event_handler import (
    EventHandler,
    PublisherEventCallbacks,
    QoSLivelinessChangedInfo,
    QoSLivelinessLostInfo,
    QoSMessageLostInfo,
    QoSOfferedDeadlineMissedInfo,
    QoSOfferedIncompatibleQoSInfo,
    QoSPublisherEventType,
    QoSPublisherMatchedInfo,
    QoSRequestedDeadlineMissedInfo,
    QoSRequestedIncompatibleQoSInfo,
    QoSSubscriptionEventType,
    QoSSubscriptionMatchedInfo,
    SubscriptionEventCallbacks,
    UnsupportedEventTypeError,
)

QoSEventHandler = EventHandler

warnings.warn(
    "Importing rclpy.qos_event is deprecated, use rclpy.event_handler instead.",
    DeprecationWarning,
    stacklevel=2,
)

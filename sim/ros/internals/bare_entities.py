"""Entities without a callback: a program's own waitable waits for them and takes from them.

They have the names of rclpy's compiled part. No executor serves them; when one becomes ready, it wakes
the executors that wait for it.
"""

from typing import Any

from sim.ros.clocks.ros_time_schedule import next_due
from sim.ros.context.context import Context
from sim.ros.entities.client import Client
from sim.ros.entities.entity_handles import RequestId, ServiceInfo
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.entities.message_info import MessageInfo
from sim.ros.entities.service import Service
from sim.ros.entities.subscription import Subscription
from sim.ros.handle import Handle
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, RmwQoSProfile
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import never_called
from sim.ros.scheduling.watched import BareEntity, Watcher


class BareSubscription(BareEntity, Subscription):
    """A subscription from which the program takes messages itself."""

    def __init__(self, node: Handle, msg_type: type, topic: str, qos_profile: RmwQoSProfile) -> None:
        owner: Node = node.owner
        name = owner.resolve_topic_name(topic)
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        with owner.context.host.lock:
            super().__init__(
                owner, msg_type, name, never_called, ReentrantCallbackGroup(), _as_profile(qos_profile),
                topic=topic, event_callbacks=silent,
            )  # fmt: skip
            owner.context.network.join_subscription(self)

    def take_message(self, msg_type: type, raw: bool) -> tuple[Any, MessageInfo] | None:
        """Take the oldest message (``raw``: as bytes) with its info; None without a message."""
        return self.handle.take_message(msg_type, raw)

    def destroy(self) -> None:
        """Remove it from the network."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self.node.context.network.leave_subscription(self)


class BareClient(BareEntity, Client):
    """A client from which the program takes responses itself."""

    def __init__(self, node: Handle, srv_type: Any, srv_name: str, qos_profile: RmwQoSProfile) -> None:
        owner: Node = node.owner
        name, profile = owner.resolve_service_name(srv_name), _as_profile(qos_profile)
        with owner.context.host.lock:
            owner.context.network.announce_use(name)
            super().__init__(owner, srv_type, name, profile, ReentrantCallbackGroup(), srv_name=srv_name)

    def service_server_is_available(self) -> bool:
        """Whether the service is offered."""
        return self.handle.service_server_is_available()

    def send_request(self, request: Any) -> int:
        """Send a request, and return its sequence number."""
        return self.handle.send_request(request)

    def take_response(self, response_type: type) -> tuple[ServiceInfo | None, Any]:
        """Take the oldest response: its header, then the response; None for both without a response."""
        return self.handle.take_response(response_type)

    def destroy(self) -> None:
        """Mark the client as destroyed."""
        self.destroyed = True


class BareService(BareEntity, Service):
    """A service from which the program takes requests itself, and answers them."""

    def __init__(self, node: Handle, srv_type: Any, srv_name: str, qos_profile: RmwQoSProfile) -> None:
        owner: Node = node.owner
        name, profile = owner.resolve_service_name(srv_name), _as_profile(qos_profile)
        group = ReentrantCallbackGroup()
        with owner.context.host.lock:
            super().__init__(owner, srv_type, name, never_called, group, profile, srv_name=srv_name)
            owner.context.network.join_service(self)

    def service_take_request(self, request_type: type) -> tuple[Any, ServiceInfo | None]:
        """Take the oldest request: the request, then its header; None for both without a request."""
        return self.handle.service_take_request(request_type)

    def service_send_response(self, response: Any, header: ServiceInfo | RequestId) -> None:
        """Send a response to the request of a header."""
        self.handle.service_send_response(response, header)

    def destroy(self) -> None:
        """Remove it from the network."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self.node.context.network.leave_service(self)


class BareTimer(BareEntity):
    """A timer that the program calls itself; all times are nanoseconds."""

    def __init__(self, clock: Handle, context: Handle, period_nsec: int, autostart: bool = True) -> None:
        owner: Context = context.owner
        self._host = owner.host
        self._period = period_nsec
        self._last_call = self._host.clock.now()
        self._due = self._last_call + period_nsec
        self._canceled = not autostart

    def check(self, watcher: Watcher, now: int) -> bool:
        """Whether the timer is due. Called with the host's lock held."""
        super().check(watcher, now)
        return not self._canceled and self._due <= now

    def next_due(self) -> int | None:
        """When the timer is due; None while it is cancelled."""
        return None if self._canceled else self._due

    def is_timer_ready(self) -> bool:
        """Whether the timer is due."""
        return not self._canceled and self._due <= self._host.clock.now()

    def call_timer(self) -> None:
        """Count a call, and set the next due time."""
        with self._host.lock:
            self._last_call = self._host.clock.now()
            self._due = next_due(self._due, self._period, self._last_call)

    def cancel_timer(self) -> None:
        """Stop the timer until ``reset_timer``."""
        self._canceled = True

    def is_timer_canceled(self) -> bool:
        """Whether the timer is cancelled."""
        return self._canceled

    def reset_timer(self) -> None:
        """Restart the timer: it is due one period from now."""
        with self._host.lock:
            self._canceled = False
            self._due = self._host.clock.now() + self._period
            for each in tuple(self._watchers):
                each.wake()

    def get_timer_period(self) -> int:
        """The period."""
        return self._period

    def change_timer_period(self, period_nsec: int) -> None:
        """Set the period from the next call on."""
        self._period = period_nsec

    def time_until_next_call(self) -> int | None:
        """The time until the timer is due; None while it is cancelled."""
        return None if self._canceled else self._due - self._host.clock.now()

    def time_since_last_call(self) -> int:
        """The time since the last call, or since the creation."""
        return self._host.clock.now() - self._last_call


def _as_profile(profile: RmwQoSProfile) -> QoSProfile:
    return QoSProfile(**profile.to_dict())

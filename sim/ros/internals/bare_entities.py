"""Entities without a callback: what a program's own waitable waits for, and takes from, itself.

They are what rclpy's compiled part calls by the same names. No executor serves them; what they have makes
the executors that wait for them look again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sim.ros.clocks.ros_time_schedule import next_due
from sim.ros.entities.client import Client
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.entities.service import Service
from sim.ros.entities.subscription import Subscription
from sim.ros.qos.qos import QoSProfile, RmwQoSProfile
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.entity import never_called
from sim.ros.scheduling.watched import BareEntity, Watcher

if TYPE_CHECKING:
    from sim.ros.context.context import Context
    from sim.ros.entities.entity_handles import RequestId, ServiceInfo
    from sim.ros.entities.message_info import MessageInfo
    from sim.ros.handle import Handle
    from sim.ros.node.node import Node


class BareSubscription(BareEntity, Subscription):
    """A subscription whose messages the program takes itself."""

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
        """Take the oldest message, as bytes if ``raw``, with its info; None without one."""
        return self.handle.take_message(msg_type, raw)

    def destroy(self) -> None:
        """Take it off the network."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self.node.context.network.leave_subscription(self)


class BareClient(BareEntity, Client):
    """A client whose responses the program takes itself."""

    def __init__(self, node: Handle, srv_type: Any, srv_name: str, qos_profile: RmwQoSProfile) -> None:
        owner: Node = node.owner
        name, profile = owner.resolve_service_name(srv_name), _as_profile(qos_profile)
        with owner.context.host.lock:
            owner.context.network.announce_use(name)
            super().__init__(owner, srv_type, name, profile, ReentrantCallbackGroup(), srv_name=srv_name)

    def service_server_is_available(self) -> bool:
        """Whether somebody offers the service."""
        return self.handle.service_server_is_available()

    def send_request(self, request: Any) -> int:
        """Send a request; returns its sequence number."""
        return self.handle.send_request(request)

    def take_response(self, response_type: type) -> tuple[ServiceInfo | None, Any]:
        """Take the oldest response, after which request it came; None twice without one."""
        return self.handle.take_response(response_type)

    def destroy(self) -> None:
        """Take no more responses."""
        self.destroyed = True


class BareService(BareEntity, Service):
    """A service whose requests the program takes and answers itself."""

    def __init__(self, node: Handle, srv_type: Any, srv_name: str, qos_profile: RmwQoSProfile) -> None:
        owner: Node = node.owner
        name, profile = owner.resolve_service_name(srv_name), _as_profile(qos_profile)
        group = ReentrantCallbackGroup()
        with owner.context.host.lock:
            super().__init__(owner, srv_type, name, never_called, group, profile, srv_name=srv_name)
            owner.context.network.join_service(self)

    def service_take_request(self, request_type: type) -> tuple[Any, ServiceInfo | None]:
        """Take the oldest request, and the header to answer it by; None twice without one."""
        return self.handle.service_take_request(request_type)

    def service_send_response(self, response: Any, header: ServiceInfo | RequestId) -> None:
        """Answer the request of that header."""
        self.handle.service_send_response(response, header)

    def destroy(self) -> None:
        """Take it off the network."""
        with self.node.context.host.lock:
            if not self.destroyed:
                self.destroyed = True
                self.node.context.network.leave_service(self)


class BareTimer(BareEntity):
    """A timer that the program calls itself; all times in nanoseconds."""

    def __init__(self, clock: Handle, context: Handle, period_nsec: int, autostart: bool = True) -> None:
        owner: Context = context.owner
        self._host = owner.host
        self._period = period_nsec
        self._last_call = self._host.clock.now()
        self._due = self._last_call + period_nsec
        self._canceled = not autostart

    def look(self, watcher: Watcher, now: int) -> bool:
        """Whether it is due. With the host's lock held."""
        super().look(watcher, now)
        return not self._canceled and self._due <= now

    def next_due(self) -> int | None:
        """When it is due; None while cancelled."""
        return None if self._canceled else self._due

    def is_timer_ready(self) -> bool:
        """Whether it is due."""
        return not self._canceled and self._due <= self._host.clock.now()

    def call_timer(self) -> None:
        """Count a call, and move on to the next due time."""
        with self._host.lock:
            self._last_call = self._host.clock.now()
            self._due = next_due(self._due, self._period, self._last_call)

    def cancel_timer(self) -> None:
        """Be due no more until ``reset_timer``."""
        self._canceled = True

    def is_timer_canceled(self) -> bool:
        """Whether it was cancelled."""
        return self._canceled

    def reset_timer(self) -> None:
        """Be due one period from now."""
        with self._host.lock:
            self._canceled = False
            self._due = self._host.clock.now() + self._period
            for each in tuple(self._watchers):
                each.wake()

    def get_timer_period(self) -> int:
        """The period."""
        return self._period

    def change_timer_period(self, period_nsec: int) -> None:
        """Have another period from the next call on."""
        self._period = period_nsec

    def time_until_next_call(self) -> int | None:
        """How long until it is due; None while cancelled."""
        return None if self._canceled else self._due - self._host.clock.now()

    def time_since_last_call(self) -> int:
        """How long since it was called, or made."""
        return self._host.clock.now() - self._last_call


def _as_profile(profile: RmwQoSProfile) -> QoSProfile:
    return QoSProfile(**profile.to_dict())

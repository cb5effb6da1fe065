"""The common part of clients and services: service name and type, profile, queue and introspection."""

from collections import deque
from collections.abc import Callable
from typing import Any

from sim.interfaces import type_name
from sim.ros.clocks.clock import Clock
from sim.ros.entities.service_introspection import ServiceIntrospection, ServiceIntrospectionState
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.entity import OwnerNode


class ClientOrService:
    """The common part of the entities Client and Service.

    ``srv_name`` is the service's name as the program wrote it; ``service_name`` is the full one.
    """

    node: OwnerNode
    name: str
    depth: int
    ready_since: int
    become_idle: Callable[[], None]
    _introspection: ServiceIntrospection | None = None
    _queue: deque[Any]

    def _set_service(self, srv_type: Any, srv_name: str | None, qos_profile: QoSProfile) -> None:
        self.srv_type = srv_type
        self.interface_type = type_name(srv_type)
        self.srv_name = self.name if srv_name is None else srv_name
        self.qos_profile = qos_profile
        self.depth = qos_profile.queue_length or 0
        self._probe = self.node.context.probe
        self._queue = deque()

    @property
    def service_name(self) -> str:
        """The service's full name."""
        return self.name

    @property
    def queued(self) -> int:
        """The number of requests or replies in the queue."""
        return len(self._queue)

    def _take_oldest(self, now: int) -> Any:
        oldest = self._queue.popleft()
        if self._queue:
            self.ready_since = now
        else:
            self.become_idle()
        return oldest

    def configure_introspection(
        self,
        clock: Clock,
        service_event_qos_profile: QoSProfile,
        introspection_state: ServiceIntrospectionState,
    ) -> None:
        """Publish the steps of every call on ``<service>/_service_event``; ``OFF`` ends it."""
        chosen = ServiceIntrospectionState(introspection_state)
        with self.node.context.host.lock:
            self.stop_introspection()
            if chosen is not ServiceIntrospectionState.OFF:
                self._introspection = ServiceIntrospection(self, clock, service_event_qos_profile, chosen)

    def stop_introspection(self) -> None:
        """Stop publishing steps. Called with the host's lock held."""
        if self._introspection is not None:
            self._introspection.stop()
            self._introspection = None

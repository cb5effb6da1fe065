"""The services, clients and subscriptions of an action.

On the network a part is an ordinary endpoint with its own queue. But it makes its waitable ready instead of
itself, and the trace shows its queue as the waitable's.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.probes.probe import Probe, SilentProbe
from sim.probes.traced import TracedEntity
from sim.ros.entities.client import Client, Reply
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.entities.service import Service
from sim.ros.entities.subscription import Subscription
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.agenda import numbers
from sim.ros.scheduling.entity import Entity, never_called
from sim.ros.scheduling.task import Future

if TYPE_CHECKING:
    from sim.ros.actions.waitable import ActionWaitable


_CALLS = (
    Probe.call_id,
    Probe.service_called,
    Probe.service_replied,
    Probe.request_lost,
    Probe.call_blocked,
    Probe.call_unblocked,
)


class PartProbe(SilentProbe):
    """Records the events of a part: ``_CALLS`` as the program's probe does, the queue as the waitable's."""

    def __init__(self, owner: ActionWaitable) -> None:
        super().__init__(owner.node.context.host.clock)
        self._owner = owner
        self._program = owner.node.context.probe
        for calls in _CALLS:
            setattr(self, calls.__name__, getattr(self._program, calls.__name__))

    def ready(self, entity: TracedEntity, depth: int, message: int) -> None:
        """An item arrived for the part."""
        self._program.ready(self._owner, self._owner.queued, message)

    def dropped(self, entity: TracedEntity, depth: int, message: int) -> None:
        """The part's full queue dropped its oldest item."""
        self._program.dropped(self._owner, self._owner.queued, message)


class LatestProbe(PartProbe):
    """The probe of a part that keeps the latest message alone: it loses nothing to a newer one."""

    def dropped(self, entity: TracedEntity, depth: int, message: int) -> None:
        """Record nothing: the newer message took the place of the older one."""


class Part(Entity):
    """An entity that is served as part of a waitable."""

    traced = served = False
    _owner: ActionWaitable
    _queue: deque[Any]
    number = 0
    """With which it became ready, among all entities."""

    def become_ready(self, since: int) -> None:
        """Make the waitable ready. Called with the host's lock held."""
        if not self.pending:
            self.pending = True
            self.number = next(numbers)
        self._owner.arrived_at = self
        self._owner.become_ready(since)

    def become_idle(self) -> None:
        """This part has nothing more to take. Called with the host's lock held."""
        self.pending = False


class ServicePart(Part, Service):
    """One of an action server's services."""

    def __init__(self, owner: ActionWaitable, srv_type: Any, name: str, qos_profile: QoSProfile) -> None:
        self._owner = owner
        super().__init__(owner.node, srv_type, name, never_called, owner.parts_group, qos_profile)
        self._probe = PartProbe(owner)


class ClientPart(Part, Client):
    """One of an action client's clients."""

    def __init__(self, owner: ActionWaitable, srv_type: Any, name: str, qos_profile: QoSProfile) -> None:
        self._owner = owner
        super().__init__(owner.node, srv_type, name, qos_profile, owner.parts_group)
        self._probe = PartProbe(owner)

    def awaited(self, reply: Reply) -> Future[Any] | None:
        """The future that waits for a reply; None if there is none any more."""
        return self._pending_requests.get(reply.call)

    def wait_for(self, future: Future[Any]) -> Any:
        """Wait on this thread until a future of this client is done; return the result."""
        arrived = self._host.clock.auto_reset_event()
        future.add_done_callback(lambda _: arrived.set())
        with self._host.lock:
            call = next((call for call, each in self._pending_requests.items() if each is future), None)
        if call is not None:
            self._probe.call_blocked(call, self.name)
            try:
                arrived.wait(None)
            finally:
                self._probe.call_unblocked(call)
        return future.result()


class SubscriptionPart(Part, Subscription):
    """One of an action client's subscriptions."""

    def __init__(
        self,
        owner: ActionWaitable,
        msg_type: Any,
        name: str,
        callback: Callable[[Any], Any],
        qos_profile: QoSProfile,
    ) -> None:
        self._owner = owner
        silent = SubscriptionEventCallbacks(use_default_callbacks=False)
        group = owner.parts_group
        super().__init__(owner.node, msg_type, name, callback, group, qos_profile, event_callbacks=silent)
        self._probe = LatestProbe(owner) if self.depth == 1 else PartProbe(owner)

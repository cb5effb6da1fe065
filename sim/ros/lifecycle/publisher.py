"""Publishers that send only while their node is active."""

from typing import Any

from sim.quantities.nanoseconds import SECOND
from sim.ros.entities.publisher import Publisher
from sim.ros.lifecycle.managed_entity import SimpleManagedEntity
from sim.ros.lifecycle.state_machine import ACTIVE


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """A publisher that sends only while its node is active."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)
        self._dropped_at: int | None = None
        """When it dropped its first message."""
        self._was_active = False

    def publish(self, msg: Any) -> None:
        """Send a message if the node is active; otherwise as ``Publisher.publish``."""
        if self.is_activated:
            self._was_active = True
            Publisher.publish(self, msg)
        elif not self._was_active:
            self._note_drop()

    def _note_drop(self) -> None:
        now = self._host.clock.now()
        if self._dropped_at is None:
            self._dropped_at = now
        elif now - self._dropped_at >= SECOND:
            node: Any = self.node
            state, _ = node._state_machine.current_state
            self._probe.usage.published_inactive(self.topic_name, is_node_active=state == ACTIVE)

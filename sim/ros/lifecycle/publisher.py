"""Publishers that send only while their node is active."""

from typing import Any

from sim.ros.entities.publisher import Publisher
from sim.ros.lifecycle.managed_entity import SimpleManagedEntity


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """A publisher that sends only while its node is active."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    def publish(self, msg: Any) -> None:
        """Send a message if the node is active; otherwise as ``Publisher.publish``."""
        if self.is_activated:
            Publisher.publish(self, msg)

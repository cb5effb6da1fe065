"""Service introspection: publishes each step of a call on the topic ``<service>/_service_event``."""

from __future__ import annotations

from enum import IntEnum
from typing import TYPE_CHECKING, Any

import numpy as np

from sim.interfaces import message
from sim.ros.clocks.clock import Clock
from sim.ros.qos.qos import QoSProfile

if TYPE_CHECKING:
    from sim.ros.entities.client_or_service import ClientOrService

_TOPIC_SUFFIX = "/_service_event"


class ServiceIntrospectionState(IntEnum):
    """What is published of a call: nothing, its steps, or its steps with requests and responses."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


class ServiceIntrospection:
    """Publishes the steps of the calls of one client or service.

    Use it with the host's lock held.
    """

    def __init__(
        self, owner: ClientOrService, clock: Clock, qos_profile: QoSProfile, state: ServiceIntrospectionState
    ) -> None:
        self._event_type = owner.srv_type.Event
        self._clock = clock
        self._with_contents = state is ServiceIntrospectionState.CONTENTS
        topic = f"{owner.name}{_TOPIC_SUFFIX}"
        self._publisher = owner.node.create_publisher(self._event_type, topic, qos_profile)

    def stop(self) -> None:
        """Remove the publisher."""
        self._publisher.node.destroy_publisher(self._publisher)

    def publish_step(self, step: str, client: bytes, call: int, **contents: Any) -> None:
        """Publish a step such as ``REQUEST_SENT``, with its ``request`` or ``response`` if wanted."""
        info_type: Any = message("service_msgs", "ServiceEventInfo")
        event: Any = self._event_type()
        event.info = info_type(
            event_type=getattr(info_type, step),
            stamp=self._clock.now().to_msg(),
            client_gid=np.frombuffer(client, np.uint8),
            sequence_number=call,
        )
        if self._with_contents:
            for field, value in contents.items():
                setattr(event, field, [value])
        self._publisher.publish(event)

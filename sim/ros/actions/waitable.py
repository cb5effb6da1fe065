"""The base of action servers and clients: several services and topics, served as one callback.

An executor sees one waitable. An item for one of its parts makes it ready. A call takes the oldest item of
each part that had one at the executor's snapshot, and handles the items in the order in
which the parts were added: rclpy's ``is_ready`` remembers these parts for ``take_data``. On an
EventsExecutor, each arrival takes from one part only (``HandleWaitableReady``).
"""

from collections.abc import Callable, Container, Sequence
from typing import Any, ClassVar, NamedTuple

from sim.interfaces import ActionType
from sim.ros.actions.parts import ClientPart, Part, ServicePart, SubscriptionPart
from sim.ros.entities.event_handler import PublisherEventCallbacks
from sim.ros.entities.publisher import Publisher
from sim.ros.exceptions import NameValidationException
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import CallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.entity import Entity, TakenData
from sim.ros.scheduling.task import makes_coroutines
from sim.ros.scheduling.waitable import NumberOfEntities
from sim.trace.events import EntityKind

Handler = Callable[[Any], Any]
"""Handles the data of one part; may return a coroutine."""


class PartData(NamedTuple):
    """The data that were taken from one part, and their handler."""

    handler: Handler
    data: Any


class ActionWaitable(Entity):
    """Base of action servers and clients.

    Raises:
        AttributeError: ``action_type`` is not an action class.
        ValueError: the action's name breaks the rules.
    """

    kind = EntityKind.WAITABLE
    rank = -1
    end: ClassVar[str]
    """Which end of the action it is: ``server`` or ``client``."""

    def __init__(
        self, node: Node, action_type: Any, action_name: str, callback_group: CallbackGroup | None
    ) -> None:
        _check_is_valid_action_type(action_type)
        group = node.default_callback_group if callback_group is None else callback_group
        self.action = _full_name(node, action_name)
        super().__init__(node, f"{self.action} {self.end}", group)
        self._node = node
        self._action_type: Any = action_type
        self._action_name = action_name
        self._host = node.context.host
        self._probe = node.context.probe
        self._parts: list[tuple[Part, Handler]] = []
        self._to_take: Container[Entity | None] = ()
        # No executor serves the parts by themselves, so they are not members of the program's group.
        self.parts_group = ReentrantCallbackGroup()

    @property
    def action_type(self) -> Any:
        """The action class."""
        return self._action_type

    # Creating the parts, with the host's lock held

    def _add_service(
        self, srv_type: Any, part: str, qos_profile: QoSProfile, handler: Handler
    ) -> ServicePart:
        name = self._node.resolve_service_name(f"{self.action}/_action/{part}")
        service = ServicePart(self, srv_type, name, qos_profile)
        self._add_part(service, handler)
        self._node.context.network.join_service(service)
        return service

    def _add_client(self, srv_type: Any, part: str, qos_profile: QoSProfile, handler: Handler) -> ClientPart:
        name = self._node.resolve_service_name(f"{self.action}/_action/{part}")
        self._node.context.network.announce_use(name)
        client = ClientPart(self, srv_type, name, qos_profile)
        self._add_part(client, handler)
        return client

    def _add_subscription(
        self, msg_type: Any, part: str, qos_profile: QoSProfile, handler: Handler
    ) -> SubscriptionPart:
        name = self._node.resolve_topic_name(f"{self.action}/_action/{part}")
        subscription = SubscriptionPart(self, msg_type, name, handler, qos_profile)
        self._add_part(subscription, handler)
        self._node.context.network.join_subscription(subscription)
        return subscription

    def _add_publisher(self, msg_type: Any, part: str, qos_profile: QoSProfile) -> Publisher:
        topic = f"{self.action}/_action/{part}"
        silent = PublisherEventCallbacks(use_default_callbacks=False)
        return self._node._node_entities.create_publisher(
            msg_type, topic, qos_profile, event_callbacks=silent, callback_group=self.parts_group
        )

    def _add_part(self, part: Part, handler: Handler) -> None:
        self._parts.append((part, handler))
        self._node._agenda.add(part)

    # Taking

    @property
    def queued(self) -> int:
        """The number of items in the queues of all parts."""
        return sum(part.queued for part, _ in self._parts)

    def on_snapshot(self) -> None:
        """A snapshot contains the waitable: items that other parts get later wait for the next snapshot."""
        self._to_take = {part for part, _ in self._parts if part.pending}

    def readiness(self) -> Sequence[int]:
        """The numbers with which its parts became ready; its own if none is: a result has expired."""
        return sorted(part.number for part, _ in self._parts if part.pending) or super().readiness()

    def leave_out(self, later: int) -> None:
        """Take from no part that became ready with a later number."""
        self._to_take = {part for part, _ in self._parts if part.pending and part.number <= later}

    def arrivals(self) -> list[Part | None]:
        """The part of each queued item, part by part."""
        return [part for part, _ in self._parts for _ in part.arrivals()]

    def expect(self, arrived: Entity | None) -> None:
        """Take from one part only; None: from no part, because a result has expired."""
        self._to_take = (arrived,)

    def take(self, now: int) -> TakenData | None:
        """Take the oldest item of each part that had one at the snapshot."""
        found = [
            (taken, handler)
            for part, handler in self._parts
            if part in self._to_take and part.pending and (taken := part.take(now)) is not None
        ]
        if any(part.pending for part, _ in self._parts):
            self.ready_since = now
        else:
            self.become_idle()
        if not found:
            return None
        message = found[0][0].message
        age = max(taken.age for taken, _ in found)
        return TakenData(
            [PartData(handler, taken.data) for taken, handler in found], message, age, self.queued
        )

    async def invoke(self, taken: TakenData) -> None:
        """Handle the data of each part."""
        for handler, data in taken.data:
            await await_or_execute(handler, data)

    def get_num_entities(self) -> NumberOfEntities:
        """The number of entities of each kind."""
        return NumberOfEntities(
            num_subscriptions=sum(isinstance(part, SubscriptionPart) for part, _ in self._parts),
            num_clients=sum(isinstance(part, ClientPart) for part, _ in self._parts),
            num_services=sum(isinstance(part, ServicePart) for part, _ in self._parts),
        )

    def destroy(self) -> None:
        """Remove the waitable and its parts from the network and from the node."""
        with self._host.lock:
            for part, _ in self._parts:
                part.destroy()
            self._node._agenda.remove(self)


async def await_or_execute(callback: Callable[..., Any], *args: Any) -> Any:
    """Call a function, and await its result if it is a coroutine function."""
    outcome = callback(*args)
    return await outcome if makes_coroutines(callback) else outcome


def _full_name(node: Node, action_name: str) -> str:
    try:
        return node.resolve_service_name(action_name)
    except NameValidationException as error:
        raise ValueError(f"Invalid action name: {error}") from None


def _check_is_valid_action_type(action_type: Any) -> None:
    if not isinstance(action_type, ActionType):
        raise AttributeError(  # noqa: TRY004 -- rclpy's
            f"{action_type!r} is no action type; one is imported as from example_interfaces.action "
            "import Fibonacci"
        )

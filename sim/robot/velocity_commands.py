"""Checks the velocities sent to the robot's ``cmd_vel`` on the sender's thread, where its line is known."""

from collections.abc import Callable
from typing import Any

from sim.probes.own_code import place_of_caller
from sim.robot.drive import Velocity, is_drivable
from sim.ros.entities.subscription import Subscription
from sim.ros.middleware.delivery import Delivery
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.trace.events import AnyEvent, Notice, Severity


class VelocityCommands(Subscription):
    """The driver's subscription; ``record`` takes a notice of the first velocity that is not finite.

    The driver itself, like a real robot's, does not know the sender.
    """

    def __init__(
        self, node: Node, twist: type, callback: Callable[[Any], None], record: Callable[[AnyEvent], None]
    ) -> None:
        name = node.resolve_topic_name("cmd_vel")
        super().__init__(node, twist, name, callback, node.default_callback_group, QoSProfile(depth=10))
        self._record = record
        self._told = False

    def listen(self) -> None:
        """Start to receive messages."""
        with self.node.context.host.lock:
            self.node._agenda.add(self)
            self.node.context.network.join_subscription(self)

    def deliver(self, delivery: Delivery) -> None:
        """Take a velocity, on the sender's thread, with the host's lock held."""
        sent = delivery.data
        if not self._told and not is_drivable(Velocity(sent.linear.x, sent.angular.z)):
            self._told = True
            self._record(Notice(self._clock.now(), Severity.WARN, _sentence(sent)))
        super().deliver(delivery)


def _sentence(sent: Any) -> str:
    place = place_of_caller()
    return (
        f"the robot ignores velocities that are no numbers{f' ({place})' if place else ''}: "
        f"linear.x={sent.linear.x:g}, angular.z={sent.angular.z:g}; publish finite ones"
    )

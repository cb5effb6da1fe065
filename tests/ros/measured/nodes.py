"""The two nodes with which real rclpy was measured, their times to be chosen."""

from collections.abc import Callable
from typing import TypeAlias

from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from tests.support.simulation import Simulation

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")

Groups: TypeAlias = Callable[[], CallbackGroup | None]
"""Gives each entity that asks its group, in the order of their making."""


class SubNode(Node):
    """Hears ``odom`` and ``scan``, and once sleeps ``naps`` times ``nap`` s in its timer's callback."""

    def __init__(
        self, simulation: Simulation, groups: Groups, *, period: float = 0.5, naps: int = 10, nap: float = 1.0
    ) -> None:
        super().__init__("sub_node")
        self.sleep = simulation.sleep
        self.naps, self.nap = naps, nap
        self.rested = False
        self.heard: dict[str, list[int]] = {"odom": [], "scan": []}
        self.create_subscription(Int32, "odom", self.odom, 10, callback_group=groups())
        self.create_subscription(Int32, "scan", self.scan, 10, callback_group=groups())
        self.create_timer(period, self.timer, callback_group=groups())

    def odom(self, msg: object) -> None:
        self.heard["odom"].append(msg.data)  # type: ignore[attr-defined]

    def scan(self, msg: object) -> None:
        self.heard["scan"].append(msg.data)  # type: ignore[attr-defined]

    def timer(self) -> None:
        if not self.rested:
            self.rested = True
            for _ in range(self.naps):
                self.sleep(self.nap)


class DummyServer(Node):
    """Serves ``/dummy_server_srv`` by sleeping ``naps`` times ``nap`` s; says TICK and TACK by turns."""

    def __init__(
        self, simulation: Simulation, groups: Groups, *, period: float = 1.0, naps: int = 5, nap: float = 1.0
    ) -> None:
        super().__init__("dummy_server")
        self.sleep = simulation.sleep
        self.naps, self.nap = naps, nap
        self.ticks = 0
        self.create_service(SetBool, "/dummy_server_srv", self.serve, callback_group=groups())
        self.create_timer(period, self.timer, callback_group=groups())

    def serve(self, request: object, response: object) -> object:
        for _ in range(self.naps):
            self.sleep(self.nap)
        response.message = "TURNING"  # type: ignore[attr-defined]
        return response

    def timer(self) -> None:
        self.get_logger().info("TICK" if self.ticks % 2 == 0 else "TACK")
        self.ticks += 1


def default() -> None:
    """Leave every entity in its node's default group."""


def shared() -> Groups:
    """One exclusive group for all."""
    group = MutuallyExclusiveCallbackGroup()
    return lambda: group


def reentrant() -> Groups:
    """One reentrant group for all."""
    group = ReentrantCallbackGroup()
    return lambda: group

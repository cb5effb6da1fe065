"""The robot's driver on the model of rclpy: in a context and on a thread of its own."""

from collections.abc import Callable
from contextlib import suppress
from typing import Any

from sim.interfaces import message, service
from sim.probes.probe import PublishingProbe
from sim.robot.driver import Driver
from sim.robot.velocity_commands import VelocityCommands
from sim.robot.world import World
from sim.ros.context.context import Context
from sim.ros.exceptions import InvalidHandle, RCLError
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile, ReliabilityPolicy
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.trace.events import ROBOT_THREAD, AnyEvent, ArenaShown

_SENSOR_QOS = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)


class ModelPort:
    """`Port` on the model; ``record`` takes events of the robot."""

    message = staticmethod(message)
    service = staticmethod(service)

    def __init__(self, host: Host, record: Callable[[AnyEvent], None]) -> None:
        self.record = record
        self.now = host.clock.now
        self.sleep = host.clock.sleep
        self.context = Context(host=host, probe=PublishingProbe(host.clock, host.probe))
        self.context.init([])
        self.node = Node("robot_driver", context=self.context)

    def sensor_publisher(self, message: Any, topic: str) -> Any:
        return self.node.create_publisher(message, topic, _SENSOR_QOS)

    def hear_velocities(self, message: Any, callback: Callable[[Any], None]) -> None:
        VelocityCommands(self.node, message, callback, self.record).listen()

    def publish(self, publisher: Any, message: Any) -> int:
        return int(publisher.send(message))


def start_robot(
    host: Host,
    record: Callable[[AnyEvent], None],
    world: Callable[[], World],
    rate: float | None = None,
    *,
    at_once: bool = True,
) -> tuple[Process, Callable[[], None]]:
    """Start a robot, which is driven until the host's time ends.

    Returns the process of its driver, and the function that takes it away.
    ``world`` builds the robot's world on the driver's thread, as that takes a while. ``rate`` (Hz) is that of
    odometry and scans; None: the usual one. Unless ``at_once``, they are offered once the program could have
    done so itself.
    """
    port = ModelPort(host, record)
    driver = Driver(port, rate)

    def drive() -> None:
        with suppress(RCLError, InvalidHandle):  # it was taken away
            driver.begin(world())
            executor = SingleThreadedExecutor(context=port.context)
            executor.add_node(port.node)
            executor.spin()

    def leave() -> None:
        port.context.shutdown()
        port.node.destroy_node()
        record(ArenaShown(port.now(), (), (0, 0, 0), 0))

    if at_once:
        driver.advertise()
    driver.offer()
    port.context.process.start_thread(drive, ROBOT_THREAD)
    return port.context.process, leave

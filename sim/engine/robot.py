"""Starts the robot of a run: at the beginning, at its first use, or never."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.engine.setup import RobotUse, RunSetup
from sim.robot.names import NAMES, own_sensor
from sim.ros.middleware.host import Host
from sim.ros.middleware.process import Process, current_process
from sim.trace.events import SENSOR_TOPICS, AnyEvent, Notice, Severity

if TYPE_CHECKING:
    from sim.robot.world import World


def provide_robot(
    setup: RunSetup, host: Host, record: Callable[[AnyEvent], None], unavailable: Callable[[str], None]
) -> None:
    """Start the robot when the set-up says.

    ``unavailable`` gets a sentence if a robot cannot be started at its first use.

    Raises:
        WorldUnavailable: a robot cannot be started at the beginning; the text says what to do.
    """
    if setup.robot is RobotUse.NEVER:
        return
    if setup.robot is RobotUse.ALWAYS:
        world = _build(setup)
        _start(setup, host, record, lambda: world)
        return

    from sim.robot.bullet import WorldUnavailable

    def build() -> "World":
        try:
            return _build(setup)
        except WorldUnavailable as error:
            unavailable(str(error))
            raise

    robot = _RobotWhenUsed(lambda: _start(setup, host, record, build), host, record)
    host.network.at_use(NAMES, robot.used)


class _RobotWhenUsed:
    """A robot that joins when it is used, and leaves for good to a program that publishes for its sensors."""

    def __init__(
        self,
        start: Callable[[], tuple[Process, Callable[[], None]]],
        host: Host,
        record: Callable[[AnyEvent], None],
    ) -> None:
        self._start = start
        self._host = host
        self._record = record
        self._robot: tuple[Process, Callable[[], None]] | None = None
        self._changes = False
        """Whether it is just joining, or has left."""

    def used(self, name: str, publishes: bool) -> None:
        """Note a use of one of its names."""
        robot = self._robot
        if self._changes or (robot is not None and (not publishes or current_process() is robot[0])):
            return
        self._changes = True
        if publishes and name in SENSOR_TOPICS:
            if robot is not None:
                robot[1]()
            self._record(Notice(self._host.clock.now(), Severity.INFO, own_sensor(name)))
            return
        self._robot = robot or self._start()
        self._changes = False


def _build(setup: RunSetup) -> "World":
    from sim.robot.world import World

    return World(physics=setup.physics)


def _start(
    setup: RunSetup, host: Host, record: Callable[[AnyEvent], None], world: "Callable[[], World]"
) -> tuple[Process, Callable[[], None]]:
    from sim.robot.model_port import start_robot

    at_once = setup.robot is RobotUse.ALWAYS
    return start_robot(host, record, world, setup.sensor_rate, at_once=at_once)

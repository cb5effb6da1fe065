"""Starts the robot of a run: at the beginning, at its first use, or never."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from sim.engine.setup import RobotUse, RunSetup
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent

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
    from sim.robot.names import NAMES

    def build() -> "World":
        try:
            return _build(setup)
        except WorldUnavailable as error:
            unavailable(str(error))
            raise

    host.network.on_first_use(NAMES, lambda: _start(setup, host, record, build))


def _build(setup: RunSetup) -> "World":
    from sim.robot.world import World

    return World(physics=setup.physics)


def _start(
    setup: RunSetup, host: Host, record: Callable[[AnyEvent], None], world: "Callable[[], World]"
) -> None:
    from sim.robot.model_port import start_robot

    start_robot(host, record, world, setup.sensor_rate)

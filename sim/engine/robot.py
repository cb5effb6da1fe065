"""The robot of a run: there from the beginning, from its first use on, or never."""

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
    """Have the robot there when it is to be.

    ``unavailable`` gets the sentence that tells why one that comes with its first use cannot be.

    Raises:
        WorldUnavailable: one that is to be there from the beginning cannot be; the text says what to do.
    """
    match setup.robot:
        case RobotUse.ALWAYS:
            _start_at_once(setup, host, record)
        case RobotUse.WHEN_USED:
            _start_when_used(setup, host, record, unavailable)
        case RobotUse.NEVER:
            return


def _start_at_once(setup: RunSetup, host: Host, record: Callable[[AnyEvent], None]) -> None:
    from sim.robot.model_port import start_robot
    from sim.robot.world import World

    world = World(physics=setup.physics)
    start_robot(host, record, lambda: world, setup.sensor_rate)


def _start_when_used(
    setup: RunSetup, host: Host, record: Callable[[AnyEvent], None], unavailable: Callable[[str], None]
) -> None:
    from sim.robot.bullet import WorldUnavailable
    from sim.robot.names import NAMES

    def build() -> "World":
        from sim.robot.world import World

        try:
            return World(physics=setup.physics)
        except WorldUnavailable as error:
            unavailable(str(error))
            raise

    def start() -> None:
        from sim.robot.model_port import start_robot

        start_robot(host, record, build, setup.sensor_rate)

    host.network.on_first_use(NAMES, start)

"""A node on an EventsExecutor, and what its callbacks say."""

from collections.abc import Callable
from typing import Any

from sim.clock.schedule import Schedule
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.rclpy.experimental import EventsExecutor
from sim.ros.scheduling.task import Future
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")


class Bench:
    """A node on an EventsExecutor, and what its callbacks said."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.said: list[Any] = []
        self.node = Node("n")
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)

    def hear(self, topic: str, lasts: float = 0.0, depth: int = 10) -> Any:
        """A subscription that says the numbers it gets; returns its publisher."""

        def heard(number: Any) -> None:
            self.said.append(f"{topic}{number.data}")
            self.simulation.sleep(lasts)

        self.node.create_subscription(Int32, topic, heard, depth)
        return self.node.create_publisher(Int32, topic, 10)

    def register(self) -> None:
        """Have the executor hear of all that was made so far."""
        self.executor.spin_once(timeout_sec=0)

    def spin_once(self) -> list[Any]:
        """Spin once without waiting; what was said meanwhile."""
        before = len(self.said)
        self.executor.spin_once(timeout_sec=0)
        return self.said[before:]

    def spin_for(self, seconds: float) -> None:
        """Spin for so long at least."""
        self.executor.spin_until_future_complete(Future(), seconds)


def on_bench(
    program: Callable[[Bench], None],
    until: float = 10.0,
    distro: str = "jazzy",
    schedule: Schedule | None = None,
) -> tuple[list[Any], Trace]:
    """Run a program with a bench on virtual time: what was said, and the trace."""
    benches: list[Bench] = []

    def run(simulation: Simulation) -> None:
        benches.append(Bench(simulation))
        program(benches[0])

    trace = simulate(run, until, schedule, distro)
    return benches[0].said, trace


def numbers(count: int) -> list[Any]:
    """Messages that count up from 0."""
    return [Int32(data=each) for each in range(count)]

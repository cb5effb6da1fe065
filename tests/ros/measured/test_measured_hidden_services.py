"""A node's own services, such as those of its parameters, live in its default group and wait with it."""

import pytest

from sim.interfaces import service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import CallbackGroup, MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor
from tests.support.simulation import Simulation, simulate

GetParameters = service("rcl_interfaces", "GetParameters")


@pytest.mark.parametrize(
    ("group", "answered"),
    [
        pytest.param(None, 4.0, id="default group"),
        pytest.param(MutuallyExclusiveCallbackGroup(), 1.5, id="a group of its own"),
    ],
)
def test_a_parameter_is_told_once_the_default_group_is_free(
    group: CallbackGroup | None, answered: float
) -> None:
    replies: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("sleeper")
        node.declare_parameter("speed", 1.0)

        def sleep_once() -> None:
            timer.cancel()
            simulation.sleep(3.0)

        timer = node.create_timer(1.0, sleep_once, callback_group=group)
        outside = simulation.outside_node()
        client = outside.create_client(GetParameters, "/sleeper/get_parameters")
        simulation.spin_outside(outside)

        def ask() -> None:
            future = client.call_async(GetParameters.Request(names=["speed"]))
            future.add_done_callback(lambda _: replies.append(simulation.now))

        simulation.at(1.5, ask)
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=4.5)
    assert replies == [answered]

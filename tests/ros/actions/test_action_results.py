"""How long an action server keeps the results of its goals."""

from typing import Any

import pytest

from sim.ros.actions.server import ActionServer, ServerGoalHandle
from sim.ros.node.node import Node
from sim.ros.scheduling.task import Future
from tests.ros.actions.asker import Asker, Fibonacci, GoalStatus, spin_for, succeed
from tests.support.simulation import Simulation, simulate


@pytest.mark.parametrize(("timeout", "left"), [(1, 0), (3, 2), (-1, 2)])
def test_results_are_kept_for_a_while_after_the_end(timeout: float, left: int) -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        server = ActionServer(asker.node, Fibonacci, "fibonacci", succeed, result_timeout=timeout)
        for number in (1, 2):
            asker.send(number)
            asker.result(number)
        spin_for(asker.node, 2.0)
        assert len(server._goal_handles) == left
        known = asker.result(1).status != GoalStatus.STATUS_UNKNOWN
        assert known == bool(left)

    simulate(program)


def test_results_are_kept_10_s_and_counted_from_the_end_of_the_goal() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        def execute(goal_handle: ServerGoalHandle) -> Any:
            simulation.sleep(5.0)
            return succeed(goal_handle)

        ActionServer(asker.node, Fibonacci, "fibonacci", execute)
        asker.send(1)
        assert simulation.now == 5.0
        spin_for(asker.node, 9.9)
        assert asker.result(1).status == GoalStatus.STATUS_SUCCEEDED
        spin_for(asker.node, 0.2)
        assert asker.result(1).status == GoalStatus.STATUS_UNKNOWN

    simulate(program)


def test_a_goal_forgotten_while_its_result_is_awaited_is_answered_all_the_same() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        async def execute(goal_handle: ServerGoalHandle) -> Any:
            goal_handle.succeed()
            await later
            assert goal_handle.status == GoalStatus.STATUS_UNKNOWN
            assert not goal_handle.is_active
            goal_handle.publish_feedback(Fibonacci.Feedback())
            goal_handle.abort()
            return Fibonacci.Result(sequence=[3])

        later: Future[None] = Future()
        ActionServer(asker.node, Fibonacci, "fibonacci", execute, result_timeout=1)
        asker.send(1)
        simulation.at(3.0, lambda: later.set_result(None))
        assert list(asker.result(1).result.sequence) == [3]
        assert asker.feedback == []

    simulate(program)

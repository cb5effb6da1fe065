"""Goals that somebody wants cancelled."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.ros.actions.server import ActionServer, CancelResponse, ServerGoalHandle
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor
from tests.ros.actions.asker import Asker, CancelGoal, Fibonacci, GoalStatus, Impl
from tests.support.simulation import Simulation, simulate


def cancelled_by(answer: Callable[[Any], Any] | None, reply: Callable[[Any], None]) -> None:
    """Cancel a goal that runs for 2 s at 1 s, and let ``reply`` judge the answer."""

    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))

        def execute(goal_handle: ServerGoalHandle) -> Any:
            simulation.sleep(2.0)
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
            else:
                goal_handle.succeed()
            return Fibonacci.Result()

        group = ReentrantCallbackGroup()
        ActionServer(
            asker.node, Fibonacci, "fibonacci", execute, cancel_callback=answer, callback_group=group
        )
        executor = MultiThreadedExecutor(3)
        executor.add_node(asker.node)
        simulation.start(executor.spin)
        future = asker.goals.call_async(asker.goal(1))
        simulation.sleep(1.0)
        assert future.done()
        request = CancelGoal.Request()
        cancelled = asker.cancels.call_async(request)
        result = asker.results.call_async(Impl.GetResultService.Request(goal_id=asker.goal(1).goal_id))
        simulation.sleep(2.0)
        reply((cancelled.result(), result.result()))

    simulate(program)


def test_a_granted_cancel_request_lets_the_goal_end_as_canceled() -> None:
    def judge(answers: Any) -> None:
        cancel, result = answers
        assert [int(info.goal_id.uuid[0]) for info in cancel.goals_canceling] == [1]
        assert result.status == GoalStatus.STATUS_CANCELED

    cancelled_by(lambda _: CancelResponse.ACCEPT, judge)


@pytest.mark.parametrize("answer", [None, lambda _: CancelResponse.REJECT, lambda _: True])
def test_a_cancel_request_that_is_not_granted_changes_nothing(answer: Callable[[Any], Any] | None) -> None:
    def judge(answers: Any) -> None:
        cancel, result = answers
        assert list(cancel.goals_canceling) == []
        assert result.status == GoalStatus.STATUS_SUCCEEDED

    cancelled_by(answer, judge)


def test_a_goal_cancelled_before_it_began_is_executed_as_canceling() -> None:
    def program(simulation: Simulation) -> None:
        asker = Asker(Node("n"))
        begun: list[ServerGoalHandle] = []

        def execute(goal_handle: ServerGoalHandle) -> Any:
            assert goal_handle.is_cancel_requested
            goal_handle.canceled()
            return Fibonacci.Result()

        ActionServer(
            asker.node,
            Fibonacci,
            "fibonacci",
            execute,
            handle_accepted_callback=begun.append,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
        )
        asker.send(1)
        assert len(asker.cancel(1).goals_canceling) == 1
        assert begun[0].status == GoalStatus.STATUS_CANCELING
        begun[0].execute()
        assert asker.result(1).status == GoalStatus.STATUS_CANCELED
        assert asker.cancel(1).return_code == CancelGoal.Response.ERROR_GOAL_TERMINATED
        assert asker.cancel(2).return_code == CancelGoal.Response.ERROR_UNKNOWN_GOAL_ID

    simulate(program)

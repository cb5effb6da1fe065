"""Goals at work: on which thread, in which order with everything else, and what the lanes show of them."""

from functools import partial
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import action
from sim.ros.actions import ActionClient, ActionServer, CancelResponse, GoalResponse
from sim.ros.actions.server import ServerGoalHandle
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from sim.trace.events import (
    CallbackResumed,
    CallbackSuspended,
    EntityAppeared,
    EntityKind,
    EntityReady,
    GroupAppeared,
    GroupKind,
    Logged,
    Published,
    Reason,
    WaitStarted,
)
from tests.support.simulation import Simulation, Trace, simulate

Fibonacci = action("example_interfaces", "Fibonacci")


def sleeper(simulation: Simulation, seconds: float) -> Any:
    """An execute callback that takes a while."""

    def execute(goal_handle: ServerGoalHandle) -> Any:
        goal_handle.publish_feedback(Fibonacci.Feedback())
        simulation.sleep(seconds)
        goal_handle.succeed()
        return Fibonacci.Result()

    return execute


def outside_client(simulation: Simulation) -> ActionClient:
    """A client of another process, served on a thread of its own."""
    node = simulation.outside_node()
    client = ActionClient(node, Fibonacci, "count")
    simulation.spin_outside(node)
    return client


def ticking(server_group: Any, threads: int, goals: int) -> Trace:
    """A node with a 1 s timer and an action whose goals take 3.5 s, sent at 0.5 s."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        ActionServer(node, Fibonacci, "count", sleeper(simulation, 3.5), callback_group=server_group())
        node.create_timer(1.0, tick)
        client = outside_client(simulation)
        for _ in range(goals):
            simulation.at(0.5, lambda: client.send_goal_async(Fibonacci.Goal()))
        executor = SingleThreadedExecutor() if threads == 1 else MultiThreadedExecutor(threads)
        executor.add_node(node)
        executor.spin()

    def tick() -> None:
        """Show that the node is alive."""

    return simulate(program, until=6.5)


def test_a_goal_at_work_holds_up_everything_in_a_single_threaded_executor() -> None:
    trace = ticking(ReentrantCallbackGroup, 1, 1)
    assert trace.times("tick") == [4.0, 5.0, 6.0]


def test_a_goal_at_work_holds_a_worker_but_not_its_servers_group() -> None:
    trace = ticking(lambda: None, 2, 1)
    assert trace.times("tick") == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert {call.thread for call in trace.calls("tick")} != {call.thread for call in trace.calls("execute")}


@pytest.mark.parametrize(("threads", "ends"), [(2, [4.0, 4.0]), (3, [4.0, 4.0])])
def test_goals_run_side_by_side_even_if_their_servers_group_is_exclusive(
    threads: int, ends: list[float]
) -> None:
    trace = ticking(MutuallyExclusiveCallbackGroup, threads, 2)
    assert trace.times("execute") == [0.5, 0.5]
    assert trace.ends("execute") == ends


def test_who_waits_for_a_worker_is_told_that_a_goal_has_it() -> None:
    trace = ticking(ReentrantCallbackGroup, 1, 1)
    (wait,) = trace.of(WaitStarted)
    assert wait.reason is Reason.NO_FREE_WORKER
    assert wait.holder == trace.entity("execute")


def test_an_execute_callback_has_a_lane_entry_in_no_group() -> None:
    trace = ticking(lambda: None, 1, 1)
    shown = {each.entity: each for each in trace.of(EntityAppeared)}
    execution = shown[trace.entity("execute")]
    assert (execution.kind, execution.name) == (EntityKind.WAITABLE, "/count")
    assert execution.file == __file__
    members = [each for each in shown.values() if each.group == execution.group]
    assert members == [execution]
    (group,) = (each for each in trace.of(GroupAppeared) if each.group == execution.group)
    assert group.kind is GroupKind.NONE


def test_what_an_execute_callback_publishes_and_logs_is_known_to_be_its() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def execute(goal_handle: ServerGoalHandle) -> Any:
            node.get_logger().info("at work")
            return sleeper(simulation, 1.0)(goal_handle)

        ActionServer(node, Fibonacci, "count", execute)
        outside_client(simulation).send_goal_async(Fibonacci.Goal())
        rclpy.spin(node)

    trace = simulate(program, until=3.0)
    mine = trace.entity("execute")
    (line,) = trace.of(Logged)
    assert line.entity == mine
    (feedback,) = (each for each in trace.of(Published) if each.topic == "/count/_action/feedback")
    assert feedback.entity == mine


def test_a_coroutine_leaves_its_lane_while_it_awaits() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        later: Future[None] = Future()

        async def execute(goal_handle: ServerGoalHandle) -> Any:
            simulation.sleep(1.0)
            await later
            simulation.sleep(1.0)
            goal_handle.succeed()
            return Fibonacci.Result()

        ActionServer(node, Fibonacci, "count", execute)
        outside_client(simulation).send_goal_async(Fibonacci.Goal())
        simulation.at(4.0, lambda: later.set_result(None))
        rclpy.spin(node)

    trace = simulate(program, until=9.0)
    mine = trace.entity("execute")
    assert trace.times("execute") == [0.0]
    assert [event.t for event in trace.of(CallbackSuspended) if event.entity == mine] == [1_000_000_000]
    assert [event.t for event in trace.of(CallbackResumed) if event.entity == mine] == [4_000_000_000]
    assert trace.ends("execute") == [5.0]


def test_requests_of_one_server_wait_for_each_other_and_for_its_group() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()

        def slowly(_goal: Any) -> GoalResponse:
            simulation.sleep(1.0)
            return GoalResponse.ACCEPT

        ActionServer(
            node,
            Fibonacci,
            "count",
            sleeper(simulation, 0.0),
            goal_callback=slowly,
            callback_group=group,
        )
        node.create_timer(1.5, lambda: simulation.sleep(1.0), group)
        client = outside_client(simulation)
        for _ in range(2):
            client.send_goal_async(Fibonacci.Goal())
        executor = MultiThreadedExecutor(4)
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=2.9)
    assert trace.times("/count server") == [0.0, 1.0]
    assert trace.times("<lambda>") == [2.0]
    server = trace.entity("/count server")
    held = [wait for wait in trace.of(WaitStarted) if wait.reason is Reason.GROUP_HELD]
    assert [(wait.t, wait.entity, wait.holder) for wait in held] == [
        (0, server, server),
        (1_500_000_000, trace.entity("<lambda>"), server),
    ]


def test_a_waitable_goes_before_all_else_that_is_ready() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, tick)
        ActionServer(node, Fibonacci, "count", sleeper(simulation, 0.0))
        client = outside_client(simulation)
        simulation.at(1.0, lambda: client.send_goal_async(Fibonacci.Goal()))
        simulation.sleep(1.5)
        rclpy.spin(node)

    def tick() -> None:
        """Be late."""

    trace = simulate(program, until=1.9)
    assert trace.order() == ["/count server", "tick", "execute"]


def test_one_call_takes_the_oldest_of_each_kind_goals_before_cancels_before_results() -> None:
    def program(simulation: Simulation) -> None:
        node, order = Node("n"), list[str]()

        def answer(kind: str, response: Any) -> Any:
            order.append(kind)
            return response

        ActionServer(
            node,
            Fibonacci,
            "count",
            sleeper(simulation, 0.0),
            goal_callback=lambda _: answer("goal", GoalResponse.ACCEPT),
            handle_accepted_callback=lambda _: answer("accepted", None),
            cancel_callback=lambda _: answer("cancel", CancelResponse.ACCEPT),
        )
        client = outside_client(simulation)
        goal_handles: list[Any] = []
        for _ in range(2):
            future = client.send_goal_async(Fibonacci.Goal())
            future.add_done_callback(lambda each: goal_handles.append(each.result()))
        rclpy.spin_once(node)
        rclpy.spin_once(node)
        simulation.sleep(0.1)
        assert order == ["goal", "accepted", "goal", "accepted"]
        order.clear()
        for goal_handle in goal_handles:
            goal_handle.cancel_goal_async()
        client.send_goal_async(Fibonacci.Goal())
        rclpy.spin_once(node)
        assert order == ["goal", "accepted", "cancel"]

    trace = simulate(program)
    arrived = [
        event.depth for event in trace.of(EntityReady) if event.entity == trace.entity("/count server")
    ]
    assert arrived == [1, 2, 1, 2, 3]


def test_a_goal_may_be_begun_after_its_node_left_its_executor_and_runs_when_that_spins_again() -> None:
    def program(simulation: Simulation) -> None:
        node, begun = Node("n"), list[ServerGoalHandle]()
        ActionServer(
            node, Fibonacci, "count", sleeper(simulation, 1.0), handle_accepted_callback=begun.append
        )
        outside_client(simulation).send_goal_async(Fibonacci.Goal())
        rclpy.spin_once(node)
        begun[0].execute()
        assert begun[0].is_active
        rclpy.spin_once(node)
        assert not begun[0].is_active

    simulate(program)


def test_a_goal_is_at_work_before_a_client_of_the_same_executor_hears_that_it_is_accepted() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: 40 of 40 goals, on pools of 2 and 3.
    said: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def execute(goal: ServerGoalHandle) -> Any:
            said.append("at work")
            goal.succeed()
            return Fibonacci.Result()

        def send() -> None:
            accepted = client.send_goal_async(Fibonacci.Goal())
            accepted.add_done_callback(lambda _: said.append("accepted"))

        ActionServer(node, Fibonacci, "f", execute, callback_group=MutuallyExclusiveCallbackGroup())
        client = ActionClient(node, Fibonacci, "f", callback_group=MutuallyExclusiveCallbackGroup())
        node.create_timer(0.2, send, MutuallyExclusiveCallbackGroup())
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=0.7)
    assert said == ["at work", "accepted"] * 3


@pytest.mark.parametrize("threads", [2, 3])
def test_a_goal_that_is_aborted_with_a_line_ends_behind_what_others_can_do_meanwhile(threads: int) -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: 68 of 68 runs, also where the callback only sets no state.
    ends: list[tuple[int, int]] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def execute(goal: ServerGoalHandle) -> Any:
            if goal.request.order == 1:
                raise ValueError("no way")
            goal.succeed()
            return Fibonacci.Result()

        def send() -> None:
            timer.cancel()
            for order in (1, 2):
                goal = client.send_goal_async(Fibonacci.Goal(order=order))
                goal.add_done_callback(partial(accepted, order))

        def accepted(order: int, goal: Any) -> None:
            result = goal.result().get_result_async()
            result.add_done_callback(lambda done: ends.append((order, done.result().status)))

        ActionServer(node, Fibonacci, "f", execute, callback_group=ReentrantCallbackGroup())
        client = ActionClient(node, Fibonacci, "f", callback_group=MutuallyExclusiveCallbackGroup())
        timer = node.create_timer(0.2, send)
        executor = MultiThreadedExecutor(threads)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=0.5)
    assert ends == [(2, 4), (1, 6)]


@pytest.mark.parametrize(
    ("pause", "order"), [(0.0, ["ends", "accepted", "1", "2"]), (0.3, ["accepted", "ends", "1", "2"])]
)
def test_a_callback_goes_on_when_it_has_sent_feedback(pause: float, order: list[str]) -> None:
    # Measured on Jazzy 7.1.5: 6 of 6 runs each.
    said: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def execute(goal: ServerGoalHandle) -> Any:
            if pause:
                simulation.sleep(pause)
            for number in (1, 2):
                goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
            said.append("ends")
            goal.succeed()
            return Fibonacci.Result()

        def send() -> None:
            timer.cancel()
            sent = client.send_goal_async(
                Fibonacci.Goal(), lambda heard: said.append(str(heard.feedback.sequence[0]))
            )
            sent.add_done_callback(lambda _: said.append("accepted"))

        group = ReentrantCallbackGroup()
        ActionServer(node, Fibonacci, "f", execute, callback_group=group)
        client = ActionClient(node, Fibonacci, "f", callback_group=group)
        timer = node.create_timer(0.2, send)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    simulate(program, until=1.0, distro="jazzy@7.1.5")
    assert said == order

"""Waitables of an EventsExecutor: deadlines, a program's own, and actions."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import action
from sim.ros.actions import ActionClient, ActionServer, GoalResponse
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.internals import compiled as _rclpy
from sim.ros.qos.qos import QoSProfile
from sim.ros.time.duration import Duration
from tests.ros.scheduling.events_executor.bench import Bench, Int32, on_bench
from tests.ros.scheduling.waitables import QOS, Waiting

Fibonacci = action("example_interfaces", "Fibonacci")


def _deadline(bench: Bench) -> Callable[[], Any]:
    """A subscription whose deadline passes."""
    callbacks = SubscriptionEventCallbacks(deadline=bench.said.append)
    qos = QoSProfile(depth=1, deadline=Duration(seconds=1))
    bench.node.create_subscription(Int32, "d", lambda _: None, qos, event_callbacks=callbacks)
    bench.node.create_publisher(Int32, "d", qos).publish(Int32())
    return lambda: bench.said[0].total_count == 1


def _waitable(bench: Bench) -> Callable[[], Any]:
    """A waitable of the program's own, for a message."""
    with bench.node.handle:
        subscription = _rclpy.Subscription(bench.node.handle, Int32, "w", QOS)
    waiting = Waiting("subscription", subscription, lambda each: each.take_message(Int32, False)[0])
    bench.node.add_waitable(waiting)
    publisher = bench.node.create_publisher(Int32, "w", 1)
    bench.simulation.at(1.0, lambda: publisher.publish(Int32(data=3)))
    return lambda: waiting.future.result() == Int32(data=3)


def _goal(bench: Bench) -> Callable[[], Any]:
    """An action server, and a goal that is sent to it."""

    def execute(goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result(sequence=[1])

    ActionServer(bench.node, Fibonacci, "f", execute)
    client = ActionClient(bench.node, Fibonacci, "f")
    results: list[Any] = []

    async def send() -> None:
        timer.cancel()
        goal: Any = await client.send_goal_async(Fibonacci.Goal())
        results.append((await goal.get_result_async()).result)

    timer = bench.node.create_timer(0.5, send)
    return lambda: results == [Fibonacci.Result(sequence=[1])]


def test_a_guard_condition_is_refused_out_of_spin() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_guard_condition(lambda: None)
        with pytest.raises(RuntimeError, match="Guard conditions not supported"):
            bench.executor.spin_once(timeout_sec=1)

    on_bench(program)


@pytest.mark.parametrize("make", [_deadline, _waitable, _goal])
def test_what_rclpy_calls_waitables_is_served_as_a_task(make: Callable[[Bench], Any]) -> None:
    def program(bench: Bench) -> None:
        heard = make(bench)
        bench.spin_for(2.0)
        bench.said.append(heard())

    assert on_bench(program)[0][-1]


def test_an_action_is_a_task_behind_what_its_message_found_queued() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2.
    def program(bench: Bench) -> None:
        def goal(_: Any) -> GoalResponse:
            bench.said.append("goal")
            return GoalResponse.ACCEPT

        def execute(goal: Any) -> Any:
            bench.said.append("execute")
            goal.succeed()
            return Fibonacci.Result()

        def count(number: int) -> None:
            bench.said.append(number)
            if number < 4:
                bench.executor.create_task(count, number + 1)

        def send() -> None:
            timer.cancel()
            accepted = client.send_goal_async(Fibonacci.Goal())
            accepted.add_done_callback(lambda _: bench.said.append("accepted"))
            bench.executor.create_task(count, 0)

        ActionServer(bench.node, Fibonacci, "f", execute, goal_callback=goal)
        client = ActionClient(bench.node, Fibonacci, "f")
        timer = bench.node.create_timer(0.5, send)
        bench.spin_for(1.0)

    assert on_bench(program)[0] == [0, "goal", 1, "execute", 2, 3, "accepted", 4]


def test_the_end_of_a_goal_has_timers_looked_at_once_more() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: the timer by which rcl forgets goals is among them.
    def program(bench: Bench) -> None:
        def execute(goal: Any) -> Any:
            bench.simulation.sleep(0.3)
            goal.succeed()
            return Fibonacci.Result()

        def send() -> None:
            timer.cancel()
            client.send_goal_async(Fibonacci.Goal())

        ActionServer(bench.node, Fibonacci, "f", execute)
        client = ActionClient(bench.node, Fibonacci, "f")
        timer = bench.node.create_timer(0.5, send)
        bench.node.create_timer(0.6, lambda: bench.said.append(round(bench.simulation.now, 3)))
        bench.spin_for(2.0)

    assert on_bench(program)[0] == [0.8, 0.8, 1.8]


def test_a_programs_waitable_may_have_no_guard_condition() -> None:
    def program(bench: Bench) -> None:
        with bench.node.context.handle:
            guard = _rclpy.GuardCondition(bench.node.context.handle)
        bench.node.add_waitable(Waiting("guard_condition", guard, lambda _: None))
        with pytest.raises(RuntimeError, match="Guard conditions not supported"):
            bench.executor.spin_once(timeout_sec=1)

    on_bench(program)

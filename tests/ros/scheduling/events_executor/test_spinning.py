"""Spinning an EventsExecutor: what begins it, what ends it, and what an exception leaves behind."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.node.node import Node
from sim.ros.rclpy.experimental import EventsExecutor
from sim.ros.rclpy.experimental.events_executor import EventsExecutor as TheSame
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waiting_ends import ExternalShutdownException
from sim.trace.events import Reason, WaitStarted
from tests.ros.scheduling.events_executor.bench import Bench, Int32, numbers, on_bench


def test_both_modules_that_programs_import_it_from_have_it() -> None:
    assert TheSame is EventsExecutor


def test_spin_once_runs_one_callback_and_stops() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        for each in numbers(2):
            a.publish(each)
        bench.said.append(bench.spin_once())

    assert on_bench(program)[0] == ["a0", ["a0"]]


def test_a_negative_timeout_does_not_wait() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"))
        bench.executor.spin_once(timeout_sec=-1)
        bench.said.append(bench.simulation.now)

    assert on_bench(program)[0] == [0.0]


def test_a_timeout_ends_nothing_as_long_as_there_are_events() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=0.2)
        bench.register()
        for each in numbers(5):
            a.publish(each)
        bench.spin_for(0.3)
        bench.said.append(round(bench.simulation.now, 3))

    # Measured on Jazzy 7.1.5: back 1.0 s later, not 0.3.
    assert on_bench(program)[0] == ["a0", "a1", "a2", "a3", "a4", 1.0]


def test_a_done_future_ends_the_spinning_and_leaves_the_rest_in_the_queue() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        future: Future[int] = Future()
        bench.executor.create_task(future.set_result, 1)
        a.publish(Int32(data=0))
        bench.executor.spin_until_future_complete(future)
        bench.said.append("done")
        bench.spin_for(0.1)

    assert on_bench(program)[0] == ["done", "a0"]


def test_it_cannot_be_spun_while_it_spins() -> None:
    def program(bench: Bench) -> None:
        def nested() -> None:
            with pytest.raises(RuntimeError, match="Attempt to spin an already-spinning Executor"):
                bench.executor.spin_once()
            bench.said.append("refused")

        bench.node.create_timer(1.0, nested)
        bench.executor.spin_once()

    assert on_bench(program)[0] == ["refused"]


def test_an_exception_is_logged_and_leaves_spin_and_the_next_spin_comes_back_at_once() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")

        def fail(_: Any) -> None:
            raise ValueError("boo")

        bench.node.create_subscription(Int32, "a", fail, 10)
        bench.register()
        a.publish(Int32(data=0))
        a.publish(Int32(data=1))
        bench.said.append(bench.spin_once())
        with pytest.raises(ValueError, match="boo"):
            bench.spin_once()
        bench.said.append(bench.spin_once())
        bench.said.append(bench.spin_once())

    said, trace = on_bench(program)
    assert said == ["a0", ["a0"], [], "a1", ["a1"]]
    fatal, where = trace.said()
    assert fatal == "Exception in 'subscriptions' callback: boo"
    assert where.startswith("Error occurred at:\n")
    assert "in fail" in where
    assert "scheduling/" not in where.partition("in fail")[0].replace("tests/ros/scheduling", "")


@pytest.mark.parametrize("nodes", [1, 2])
def test_an_exception_of_a_task_leaves_spin_where_rclpy_with_one_node_would_crash(nodes: int) -> None:
    def program(bench: Bench) -> None:
        async def fail() -> None:
            raise ValueError("boo")

        if nodes == 2:
            bench.executor.add_node(Node("other"))
        bench.executor.create_task(fail)
        with pytest.raises(ValueError, match="boo"):
            bench.executor.spin_once()

    said = on_bench(program)[1].said()
    assert said[0] == "Exception in 'task' callback: boo"
    assert any("segmentation fault" in line for line in said) is (nodes == 1)


def test_shutdown_of_the_context_lets_the_queue_run_out_first() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")

        def end() -> None:
            rclpy.shutdown()
            bench.said.append("ends")

        bench.register()
        bench.executor.create_task(end)
        a.publish(Int32(data=0))
        with pytest.raises(ExternalShutdownException):
            bench.executor.spin()
        bench.said.append(bench.executor.get_nodes())

    assert on_bench(program)[0] == ["ends", "a0", []]


def test_shutdown_from_another_thread_ends_the_spinning_and_lets_the_nodes_go() -> None:
    def program(bench: Bench) -> None:
        def end() -> None:
            bench.simulation.sleep(1.0)
            bench.said.append(bench.executor.shutdown())

        bench.node.create_timer(0.4, lambda: bench.said.append("tick"))
        bench.simulation.start(end)
        bench.executor.spin()
        bench.simulation.sleep(0)
        bench.said.append(bench.executor.get_nodes())

    assert on_bench(program)[0] == ["tick", "tick", True, []]


def test_a_callback_that_shuts_its_executor_down_waits_for_itself() -> None:
    def program(bench: Bench) -> None:
        bench.executor.create_task(lambda: bench.said.append(bench.executor.shutdown(0.5)))
        bench.executor.spin_once()
        bench.said.append(bench.simulation.now)

    assert on_bench(program)[0] == [False, 0.5]


def test_a_node_that_is_not_spun_waits_for_that() -> None:
    def program(bench: Bench) -> None:
        bench.hear("a").publish(Int32(data=0))
        bench.simulation.sleep(1.0)

    (wait,) = on_bench(program)[1].of(WaitStarted)
    assert wait.reason is Reason.NOBODY_SPINS

"""What every way to spin does: one executor at a time, timeouts, futures, shutdown."""

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.exceptions import NotInitializedException
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import (
    Executor,
    ExternalShutdownException,
    MultiThreadedExecutor,
    SingleThreadedExecutor,
)
from sim.ros.scheduling.task import Future
from tests.support.simulation import Simulation, simulate


def executor_for(node: Node, threads: int | None = None) -> Executor:
    executor = SingleThreadedExecutor() if threads is None else MultiThreadedExecutor(threads)
    executor.add_node(node)
    return executor


BOTH = pytest.mark.parametrize("threads", [None, 2], ids=["single", "multi"])


@BOTH
def test_an_executor_that_spins_cannot_be_spun_by_its_own_callback(threads: int | None) -> None:
    errors: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = executor_for(node, threads)

        def nest() -> None:
            for spin in (executor.spin, executor.spin_once):
                with pytest.raises(RuntimeError) as caught:
                    spin()
                errors.append(str(caught.value))

        node.create_timer(0.1, nest)
        executor.spin()

    simulate(program, until=0.15)
    assert errors == ["Executor is already spinning"] * 2


@BOTH
def test_an_executor_that_spins_cannot_be_spun_by_a_second_thread(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        executor = executor_for(Node("n"), threads)
        simulation.start(executor.spin)
        simulation.sleep(0.1)
        with pytest.raises(RuntimeError, match=r"^Executor is already spinning$"):
            executor.spin()

    simulate(program)


def test_rclpy_spin_inside_a_callback_of_rclpy_spin_is_the_spin_twice_error() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def nest() -> None:
            with pytest.raises(RuntimeError, match=r"^Executor is already spinning$"):
                rclpy.spin_until_future_complete(node, Future())
            rclpy.shutdown()

        node.create_timer(0.1, nest)
        rclpy.spin(node)

    simulate(program)


def test_spin_until_future_complete_inside_a_callback_takes_the_node_from_its_executor() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = executor_for(node)

        def nest() -> None:
            rclpy.spin_until_future_complete(node, Future(), timeout_sec=1.0)
            assert node not in executor.get_nodes()
            assert executor.get_nodes() == []

        node.create_timer(0.5, nest)
        node.create_timer(10.0, lambda: None)
        executor.spin()

    assert simulate(program, until=30.0).order() == ["nest"]


@BOTH
def test_spin_once_without_timeout_blocks_until_a_callback_is_ready(threads: int | None) -> None:
    ends: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(2.5, lambda: None)
        executor = executor_for(node, threads)
        executor.spin_once()
        ends.append(simulation.now)
        executor.spin_once(timeout_sec=-1.0)
        ends.append(simulation.now)

    simulate(program)
    assert ends == [2.5, 5.0]


@BOTH
def test_spin_once_with_timeout_zero_does_not_wait(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        executor = executor_for(node, threads)
        executor.spin_once(timeout_sec=0)
        assert simulation.now == 0.0

    assert simulate(program).calls() == []


@BOTH
def test_spin_once_gives_up_after_its_timeout(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        executor_for(Node("n"), threads).spin_once(timeout_sec=0.75)
        assert simulation.now == 0.75

    simulate(program)


def test_spin_once_runs_one_callback_and_keeps_the_rest_of_the_snapshot() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        first = node.create_guard_condition(lambda: order.append("first"))
        second = node.create_guard_condition(lambda: order.append("second"))
        executor = executor_for(node)
        first.trigger()
        second.trigger()
        executor.spin_once(timeout_sec=0)
        assert order == ["first"]
        first.trigger()
        executor.spin_once(timeout_sec=0)
        executor.spin_once(timeout_sec=0)
        executor.spin_once(timeout_sec=0)

    simulate(program)
    assert order == ["first", "second", "first"]


def test_rclpy_spin_once_serves_the_node_only_meanwhile() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        rclpy.spin_once(node, timeout_sec=5.0)
        assert simulation.now == 1.0
        assert rclpy.get_global_executor().get_nodes() == []
        rclpy.spin_once(node, timeout_sec=0.5)
        assert simulation.now == 1.5

    assert simulate(program).times("<lambda>") == [1.0]


@BOTH
def test_spin_until_future_complete_ends_with_the_future(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[str] = Future()
        node.create_timer(1.0, lambda: None if simulation.now < 3 else future.set_result("done"))
        executor = executor_for(node, threads)
        executor.spin_until_future_complete(future)
        assert (future.result(), simulation.now) == ("done", 3.0)

    simulate(program)


@BOTH
def test_spin_until_future_complete_ends_with_its_timeout(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        future: Future[None] = Future()
        executor = executor_for(Node("n"), threads)
        executor.spin_until_future_complete(future, timeout_sec=1.5)
        assert (future.done(), simulation.now) == (False, 1.5)
        executor.spin_until_future_complete(future, timeout_sec=0)
        assert simulation.now == 1.5

    simulate(program)


def test_spin_until_future_complete_wakes_when_another_thread_sets_the_future() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        future: Future[int] = Future()

        def set_later() -> None:
            simulation.sleep(2.0)
            future.set_result(1)

        simulation.start(set_later)
        rclpy.spin_until_future_complete(node, future)
        assert simulation.now == 2.0

    simulate(program)


def test_a_context_shut_down_from_outside_raises_in_a_single_threaded_spin() -> None:
    def program(simulation: Simulation) -> None:
        simulation.at(1.0, rclpy.shutdown)
        with pytest.raises(ExternalShutdownException):
            executor_for(Node("n")).spin()
        assert simulation.now == 1.0

    simulate(program)


def test_a_context_shut_down_from_outside_ends_a_multi_threaded_spin() -> None:
    def program(simulation: Simulation) -> None:
        simulation.at(1.0, rclpy.shutdown)
        executor_for(Node("n"), 2).spin()
        assert simulation.now == 1.0

    simulate(program)


@BOTH
def test_a_context_shut_down_by_a_callback_ends_spin(threads: int | None) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, rclpy.shutdown)
        executor_for(node, threads).spin()
        assert simulation.now == 1.0

    simulate(program)


@BOTH
def test_executor_shutdown_ends_spin_once_the_callback_that_runs_in_its_thread_has_ended(
    threads: int | None,
) -> None:
    ends: list[tuple[str, float]] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: simulation.sleep(3.0))
        executor = executor_for(node, threads)

        def shut_down() -> None:
            simulation.sleep(2.0)
            assert executor.shutdown(timeout_sec=0.5)
            ends.append(("shut down", simulation.now))

        simulation.start(shut_down)
        executor.spin()
        ends.append(("spun", simulation.now))
        simulation.sleep(5.0)

    trace = simulate(program)
    first, second = ("shut down", "spun") if threads is None else ("spun", "shut down")
    assert ends == [(first, 2.0), (second, 4.0)]
    assert trace.times("<lambda>") == [1.0]


def test_an_executor_is_a_context_manager_that_shuts_down() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with SingleThreadedExecutor() as executor:
            executor.add_node(node)
        assert executor.get_nodes() == []

    simulate(program)


def test_a_second_init_is_an_error() -> None:
    def program(simulation: Simulation) -> None:
        with pytest.raises(RuntimeError, match=r"^Context\.init\(\) must only be called once$"):
            rclpy.init()

    simulate(program)


def test_after_shutdown_one_can_begin_anew() -> None:
    def program(simulation: Simulation) -> None:
        assert rclpy.ok()
        rclpy.shutdown()
        assert not rclpy.ok()
        with pytest.raises(NotInitializedException):
            Node("n")
        rclpy.try_shutdown()
        rclpy.init(args=[])
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        rclpy.spin_once(node)

    assert simulate(program).times("<lambda>") == [1.0]


def test_the_end_of_a_run_comes_out_of_spin_as_ctrl_c_does() -> None:
    ended: list[str] = []

    def program(simulation: Simulation) -> None:
        try:
            rclpy.spin(Node("n"))
        except KeyboardInterrupt:
            ended.append("KeyboardInterrupt")

    simulate(program, until=1.0)
    assert ended == ["KeyboardInterrupt"]

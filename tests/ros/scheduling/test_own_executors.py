"""Executors that a program writes: what they are given to call, in which order, and what they may choose."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.executors import (
    ConditionReachedException,
    Executor,
    ShutdownException,
    SingleThreadedExecutor,
    TimeoutException,
    TimeoutObject,
    await_or_execute,
)
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waitable import NumberOfEntities, Waitable
from sim.trace.events import CallbackEnded, CallbackResumed, CallbackStarted, CallbackSuspended
from tests.support.simulation import Simulation, simulate

Int32 = message("std_msgs", "Int32")


class Plain(Executor):
    """Calls each handler on the thread that spins, as rclpy's own single-threaded executor does."""

    def __init__(self) -> None:
        super().__init__()
        self.served: list[tuple[Any, Any]] = []

    def _spin_once_impl(self, timeout_sec: Any = None, wait_condition: Any = lambda: False) -> None:
        try:
            handler, entity, node = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
        except (ShutdownException, TimeoutException, ConditionReachedException):
            return
        self.served.append((entity, node))
        handler()
        error = handler.exception()
        if error is not None:
            raise error


def test_a_handler_comes_with_its_entity_and_node() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(1.0, lambda: None)
        executor = Plain()
        assert executor.add_node(node)
        executor.create_task(lambda: None)
        for _ in range(2):
            executor.spin_once()
        assert executor.served == [(None, None), (timer, node)]
        assert simulation.now == 1.0

    simulate(program)


def test_what_a_callback_raises_is_its_handlers_exception() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()

        def fail() -> None:
            raise ValueError("no")

        timer = node.create_timer(1.0, fail, group)
        executor = Plain()
        executor.add_node(node)
        handler, _, _ = executor.wait_for_ready_callbacks()
        handler()
        assert handler.done()
        assert str(handler.exception()) == "no"
        assert group.can_execute(timer)

    simulate(program)


def test_a_coroutines_handler_is_yielded_again_until_it_is_done_and_then_frees_its_group() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = MutuallyExclusiveCallbackGroup()
        gate: Future[int] = Future()
        got: list[int | None] = []

        async def wait() -> None:
            got.append(await gate)

        timer = node.create_timer(1.0, wait, group)
        executor = Plain()
        executor.add_node(node)
        first, entity, _ = executor.wait_for_ready_callbacks()
        first()
        assert entity is timer
        assert not first.done()
        assert not group.can_execute(timer)
        with pytest.raises(TimeoutException):
            executor.wait_for_ready_callbacks(timeout_sec=3.0)
        gate.set_result(3)
        again, entity, of_node = executor.wait_for_ready_callbacks()
        assert (again, entity, of_node) == (first, timer, node)
        again()
        assert first.done()
        assert got == [3]
        assert group.can_execute(timer)

    trace = simulate(program, distro="lyrical")
    kinds = (CallbackStarted, CallbackSuspended, CallbackResumed, CallbackEnded)
    assert [type(each) for each in trace.events if isinstance(each, kinds)] == list(kinds)


def test_handlers_may_be_called_on_threads_of_the_programs_own() -> None:
    class Threads(Executor):
        def __init__(self, simulation: Simulation) -> None:
            super().__init__()
            self.simulation = simulation

        def _spin_once_impl(self, timeout_sec: Any = None, wait_condition: Any = lambda: False) -> None:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec, None, wait_condition)
            self.simulation.start(handler)

    def program(simulation: Simulation) -> None:
        node = Node("n")
        exclusive = MutuallyExclusiveCallbackGroup()

        def slow_one() -> None:
            simulation.sleep(0.5)

        def slow_two() -> None:
            simulation.sleep(0.5)

        def free() -> None:
            pass

        node.create_timer(1.0, slow_one, exclusive)
        node.create_timer(1.0, slow_two, exclusive)
        node.create_timer(1.0, free, ReentrantCallbackGroup())
        executor = Threads(simulation)
        executor.add_node(node)
        simulation.at(1.9, executor.shutdown)
        with pytest.raises(ShutdownException):
            executor.spin()

    trace = simulate(program)
    assert trace.times("slow_one") == [1.0]
    assert trace.times("slow_two") == [1.5]
    assert trace.times("free") == [1.0]
    assert len({each.thread for each in trace.of(CallbackStarted)}) >= 1


def test_a_handler_that_is_not_called_yet_keeps_its_entity_from_being_yielded_again() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[float] = []
        node.create_timer(1.0, lambda: ran.append(simulation.now), ReentrantCallbackGroup())
        executor = Plain()
        executor.add_node(node)
        handler, _, _ = executor.wait_for_ready_callbacks()
        with pytest.raises(TimeoutException):
            executor.wait_for_ready_callbacks(timeout_sec=2.5)
        handler()
        assert ran == [3.5]
        executor.spin_once()
        assert ran == [3.5, 4.0]

    simulate(program)


def test_a_choice_of_nodes_leaves_the_callbacks_and_timers_of_others_alone() -> None:
    def program(simulation: Simulation) -> None:
        one, two = Node("one"), Node("two")
        executor = Plain()
        timers = [each.create_timer(period, lambda: None) for each, period in ((one, 1.0), (two, 0.4))]
        for each in (one, two):
            executor.add_node(each)
        _, entity, node = executor.wait_for_ready_callbacks(nodes=[one])
        assert (entity, node, simulation.now) == (timers[0], one, 1.0)
        _, entity, node = executor.wait_for_ready_callbacks(nodes=[two])
        assert (entity, node, simulation.now) == (timers[1], two, 1.0)

    simulate(program)


def test_a_suspended_callback_of_a_node_out_of_view_goes_on_once_it_is_in_view() -> None:
    def program(simulation: Simulation) -> None:
        one, two = Node("one"), Node("two")
        gate: Future[None] = Future()
        ended: list[str] = []

        async def wait() -> None:
            await gate
            ended.append("one")

        timer = one.create_timer(1.0, wait)
        executor = Plain()
        for each in (one, two):
            executor.add_node(each)
        executor.spin_once()
        timer.cancel()
        gate.set_result(None)
        with pytest.raises(TimeoutException):
            executor.wait_for_ready_callbacks(timeout_sec=1.0, nodes=[two])
        executor.spin_once(timeout_sec=0)
        assert ended == ["one"]

    simulate(program, distro="lyrical")


def test_a_node_that_was_not_added_cannot_be_chosen() -> None:
    def program(simulation: Simulation) -> None:
        with pytest.raises(NotImplementedError, match="a node that was not added"):
            Plain().wait_for_ready_callbacks(nodes=[Node("n")])

    simulate(program)


def test_waiting_ends_with_its_condition_its_timeout_or_the_executor() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        executor = Plain()
        executor.add_node(node)
        with pytest.raises(TimeoutException):
            executor.wait_for_ready_callbacks(timeout_sec=0.5)
        assert simulation.now == 0.5
        with pytest.raises(TimeoutException):
            executor.wait_for_ready_callbacks(timeout_sec=TimeoutObject(0.5))
        assert simulation.now == 1.0
        with pytest.raises(ConditionReachedException):
            executor.wait_for_ready_callbacks(condition=lambda: True)
        executor.shutdown()
        with pytest.raises(ShutdownException):
            executor.wait_for_ready_callbacks()

    simulate(program)


def test_an_executor_may_leave_entities_out_by_its_own_rule() -> None:
    class Choosy(Plain):
        wanted: Any = None

        def can_execute(self, entity: Any) -> bool:
            return super().can_execute(entity) and entity is not self.wanted

    def program(simulation: Simulation) -> None:
        node = Node("n")
        left_out = node.create_timer(1.0, lambda: None)
        other = node.create_timer(1.0, lambda: None)
        executor = Choosy()
        executor.wanted = left_out
        executor.add_node(node)
        for _ in range(3):
            executor.spin_once()
        assert [entity for entity, _ in executor.served] == [other] * 3

    simulate(program)


def test_an_executor_that_does_not_say_how_to_spin_cannot() -> None:
    def program(simulation: Simulation) -> None:
        executor = Executor()
        for spin in (executor.spin, executor.spin_once):
            with pytest.raises(NotImplementedError):
                spin()

    simulate(program)


def test_a_program_for_humble_says_how_to_spin_by_spin_once() -> None:
    class Old(Executor):
        def spin_once(self, timeout_sec: float | None = None) -> None:
            handler, _, _ = self.wait_for_ready_callbacks(timeout_sec=timeout_sec)
            handler()

    def program(simulation: Simulation) -> None:
        node = Node("n")
        done: Future[None] = Future()
        node.create_timer(1.0, lambda: done.set_result(None))
        executor = Old()
        executor.add_node(node)
        executor.spin_until_future_complete(done, timeout_sec=5.0)
        assert simulation.now == 1.0

    simulate(program)


def test_a_programs_waitable_is_told_as_itself() -> None:
    class Once(Waitable[None]):
        ready = True

        def is_ready(self, wait_set: ProgramWaitSet) -> bool:
            return self.ready

        def take_data(self) -> None:
            self.ready = False

        async def execute(self, taken_data: None) -> None:
            pass

        def get_num_entities(self) -> NumberOfEntities:
            return NumberOfEntities()

        def add_to_wait_set(self, wait_set: ProgramWaitSet) -> None:
            pass

    def program(simulation: Simulation) -> None:
        node = Node("n")
        waitable = Once(node.default_callback_group)
        node.add_waitable(waitable)
        executor = Plain()
        executor.add_node(node)
        executor.spin_once(timeout_sec=0)
        assert executor.served == [(waitable, node)]

    simulate(program)


@pytest.mark.parametrize(("timeout", "kept"), [(0.0, True), (0.1, False)])
def test_the_rest_of_a_snapshot_is_kept_only_for_the_same_way_of_waiting(timeout: float, kept: bool) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        order: list[str] = []
        publisher = node.create_publisher(Int32, "t", 10)
        node.create_subscription(Int32, "t", lambda _: order.append("subscription"), 10)
        node.create_timer(0.0, lambda: order.append("timer"))
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        publisher.publish(Int32())
        executor.spin_once(timeout_sec=0.0)
        executor.spin_once(timeout_sec=timeout)
        assert order == ["timer", "subscription" if kept else "timer"]

    simulate(program)


def test_spinning_for_a_future_with_a_timeout_keeps_the_snapshot() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        order: list[str] = []
        done: Future[None] = Future()
        publisher = node.create_publisher(Int32, "t", 10)

        def heard(_message: Any) -> None:
            order.append("subscription")
            done.set_result(None)

        def tick() -> None:
            order.append("timer")
            simulation.sleep(0.1)

        node.create_subscription(Int32, "t", heard, 10)
        node.create_timer(0.0, tick)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        publisher.publish(Int32())
        executor.spin_until_future_complete(done, timeout_sec=5.0)
        assert order == ["timer", "subscription"]

    simulate(program)


def test_a_function_is_called_and_a_coroutine_function_awaited() -> None:
    async def double(number: int) -> int:
        return 2 * number

    def program(simulation: Simulation) -> None:
        executor = SingleThreadedExecutor()
        callbacks: list[Callable[[int], Any]] = [double, lambda number: 3 * number]
        tasks = [executor.create_task(await_or_execute, each, 7) for each in callbacks]
        for _ in tasks:
            executor.spin_once(timeout_sec=0)
        assert [task.result() for task in tasks] == [14, 21]

    simulate(program)

"""When waitables that a program writes are asked, and who goes before whom."""

from collections.abc import Callable

import pytest

from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.task import Future
from tests.ros.scheduling.waitables import (
    Flag,
    every_executor,
)
from tests.support.simulation import Simulation, simulate


@every_executor
def test_a_waitable_that_is_set_by_a_callback_is_served_next(make: Callable[[], Executor]) -> None:
    ran: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        flag = Flag(MutuallyExclusiveCallbackGroup(), ran)
        node.add_waitable(flag)
        node.create_timer(1.0, lambda: flag.waiting.append(f"{simulation.now}"))
        executor = make()
        executor.add_node(node)
        simulation.at(2.5, executor.shutdown)
        executor.spin()
        assert ran == ["1.0", "2.0"]

    simulate(program)


@every_executor
def test_a_waitable_is_asked_again_whenever_its_executor_is_woken(make: Callable[[], Executor]) -> None:
    ran: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        flag = Flag(node.default_callback_group, ran)
        executor = make()
        executor.add_node(node)
        node.add_waitable(flag)

        def set_flag() -> None:
            flag.waiting.append("set")
            executor.wake()

        simulation.at(1.0, set_flag)
        simulation.at(1.0, lambda: None)
        simulation.at(2.0, executor.shutdown)
        executor.spin()
        assert ran == ["set"]
        assert flag.asked < 10

    simulate(program)


def test_waitables_of_every_node_go_before_the_timers_of_the_first() -> None:
    def program(simulation: Simulation) -> None:
        first, second = Node("first"), Node("second")
        ran: list[str] = []
        first.create_timer(1.0, lambda: ran.append("timer"))
        flag = Flag(second.default_callback_group, ran)
        flag.waiting.append("waitable")
        second.add_waitable(flag)
        executor = SingleThreadedExecutor()
        simulation.sleep(1.0)
        for node in (first, second):
            executor.add_node(node)
        for _ in range(2):
            executor.spin_once(timeout_sec=0)
        assert ran == ["waitable", "timer"]

    simulate(program)


def test_tasks_that_never_end_do_not_starve_a_waitable() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[str] = []
        flag = Flag(node.default_callback_group, ran)
        flag.waiting.append("waitable")
        node.add_waitable(flag)
        executor = SingleThreadedExecutor()
        executor.add_node(node)

        def again() -> None:
            executor.create_task(again)

        again()
        for _ in range(3):
            executor.spin_once(timeout_sec=0)
        assert ran == ["waitable"]

    simulate(program)


@every_executor
def test_a_waitable_of_a_busy_group_is_not_asked_until_the_group_is_free(
    make: Callable[[], Executor],
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[str] = []
        group = MutuallyExclusiveCallbackGroup()
        flag = Flag(group, ran)
        node.add_waitable(flag)
        asked: list[int] = []

        def callback() -> None:
            flag.waiting.append("waitable")
            asked.append(flag.asked)
            simulation.sleep(0.5)
            asked.append(flag.asked)
            assert ran == []

        timer = node.create_timer(1.0, callback, group)
        node.create_timer(0.3, lambda: None, ReentrantCallbackGroup())
        executor = make()
        executor.add_node(node)
        simulation.at(1.9, executor.shutdown)
        executor.spin()
        assert ran == ["waitable"]
        assert asked[0] == asked[1]
        assert timer.is_ready() is False

    simulate(program)


def test_a_waitable_is_not_asked_again_while_it_takes_its_data() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[str] = []

        class Slow(Flag):
            def take_data(self) -> str:
                before = self.asked
                simulation.sleep(1.0)
                assert self.asked == before
                return super().take_data()

        flag = Slow(ReentrantCallbackGroup(), ran)
        flag.waiting.append("once")
        node.add_waitable(flag)
        node.create_timer(0.1, lambda: None, ReentrantCallbackGroup())
        executor = MultiThreadedExecutor(3)
        executor.add_node(node)
        simulation.at(1.5, executor.shutdown)
        executor.spin()
        assert ran == ["once"]

    simulate(program)


def test_execute_holds_its_group_while_it_awaits() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        ran: list[str] = []
        gate: Future[None] = Future()

        class Awaiting(Flag):
            async def execute(self, taken_data: str) -> None:
                await gate
                ran.append(taken_data)

        group = MutuallyExclusiveCallbackGroup()
        flag = Awaiting(group, ran)
        flag.waiting.append("waitable")
        node.add_waitable(flag)
        node.create_timer(1.0, lambda: ran.append("timer"), group)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        simulation.at(1.5, lambda: gate.set_result(None))
        simulation.at(1.8, executor.shutdown)
        executor.spin()
        assert ran == ["waitable", "timer"]

    simulate(program)


def test_an_execute_that_is_no_coroutine_is_a_type_error() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        class Plain(Flag):
            def execute(self, taken_data: str) -> None:  # type: ignore[override]
                pass

        flag = Plain(node.default_callback_group, [])
        flag.waiting.append("x")
        node.add_waitable(flag)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        with pytest.raises(TypeError, match=r"can't be (used in 'await' expression|awaited)"):
            executor.spin_once(timeout_sec=0)

    simulate(program)

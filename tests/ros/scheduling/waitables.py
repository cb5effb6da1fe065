"""Waitables as a program writes them, and the executors that serve them."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.qos.qos import QoSProfile
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.scheduling.program_wait_set import ProgramWaitSet
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waitable import NumberOfEntities, Waitable

Empty = message("std_msgs", "Empty")
EmptySrv = service("std_srvs", "Empty")
QOS = QoSProfile(depth=10).get_c_qos_profile()


def two_threads() -> Executor:
    return MultiThreadedExecutor(2)


every_executor = pytest.mark.parametrize("make", [SingleThreadedExecutor, two_threads])


class Waiting(Waitable[Any]):
    """Waits for one entity of one kind, and gives what it takes to a future."""

    def __init__(self, kind: str, waited: Any, take: Callable[[Any], Any]) -> None:
        super().__init__(ReentrantCallbackGroup())
        self.kind = kind
        self.waited = waited
        self.take = take
        self.index = -1
        self.found_ready = False
        self.future: Future[Any] = Future()

    def is_ready(self, wait_set: ProgramWaitSet) -> bool:
        self.found_ready = self.found_ready or wait_set.is_ready(self.kind, self.index)
        return self.found_ready

    def take_data(self) -> Any:
        self.found_ready = False
        return self.take(self.waited)

    async def execute(self, taken_data: Any) -> None:
        self.future.set_result(taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities(**{f"num_{self.kind}s": 1})

    def add_to_wait_set(self, wait_set: ProgramWaitSet) -> None:
        self.index = getattr(wait_set, f"add_{self.kind}")(self.waited)


class Flag(Waitable[str]):
    """Ready while something is in its list; wakes its executor itself."""

    def __init__(self, group: CallbackGroup, ran: list[str]) -> None:
        super().__init__(group)
        self.waiting: list[str] = []
        self.ran = ran
        self.asked = 0

    def is_ready(self, wait_set: ProgramWaitSet) -> bool:
        self.asked += 1
        return bool(self.waiting)

    def take_data(self) -> str:
        return self.waiting.pop(0)

    async def execute(self, taken_data: str) -> None:
        self.ran.append(taken_data)

    def get_num_entities(self) -> NumberOfEntities:
        return NumberOfEntities()

    def add_to_wait_set(self, wait_set: ProgramWaitSet) -> None:
        pass


def served(make: Callable[[], Executor], node: Node, waitable: Waiting) -> Any:
    """Serve a waitable until its future is done, and return the result."""
    executor = make()
    executor.add_node(node)
    node.add_waitable(waitable)
    executor.spin_until_future_complete(waitable.future, timeout_sec=10)
    assert waitable.future.done()
    node.remove_waitable(waitable)
    return waitable.future.result()

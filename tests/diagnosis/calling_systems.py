"""Random small systems whose callbacks call services that call services, and what becomes of them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypothesis import strategies as st

from sim.clock.virtual import VirtualClock
from sim.clock.virtual_threads import VirtualThread
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, executor_of, serve_outside
from tests.support.simulation import Simulation

SECONDS = 20.0
OUTSIDE = "/outside"
MOST_CALLS = 4
"""After so many a callback calls no more: services that call themselves would go on for ever."""


@dataclass(frozen=True)
class Caller:
    """A callback that works, calls a service (None: none) by a client of a group, and works again.

    Groups are numbers of the system's; lengths are tenths of a second. ``awaits``: it is a coroutine.
    """

    group: int
    client_group: int
    calls: int | None
    before: int
    after: int
    awaits: bool


@dataclass(frozen=True)
class CallingSystem:
    """One-shot timers, due at tenths of a second, and services numbered from 0 that call on in their turn.

    ``heartbeat`` is the group of a timer that does nothing, for as long as the system runs; None for no such.
    """

    groups: tuple[type[CallbackGroup], ...]
    timers: tuple[tuple[int, Caller], ...]
    services: tuple[Caller, ...]
    threads: int | None
    heartbeat: int | None


@dataclass
class Fate:
    """What the scheduler itself tells at the end: whether anything can run, and what has begun and not ended.

    ``at_work`` counts the callbacks while they run; ``unfinished`` is what was left of them at the end.
    ``heart_beats`` tells whether the heartbeat was called shortly before the end.
    """

    something_can_run: bool = True
    at_work: int = 0
    unfinished: int = 0
    heart_beats: bool = False


def calling_systems() -> st.SearchStrategy[CallingSystem]:
    """Systems of 1 to 4 timers and 0 to 3 services on 1 to 4 threads or the single-threaded executor."""
    kinds = st.sampled_from([MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup])
    group = st.integers(0, 3)
    timer = st.tuples(st.integers(1, 6), _callers(group, st.integers(0, 3)))
    return st.builds(
        CallingSystem,
        st.tuples(kinds, kinds, kinds, kinds),
        st.lists(timer, min_size=1, max_size=4).map(tuple),
        st.lists(_callers(group, st.none() | st.integers(0, 3)), max_size=3).map(tuple),
        st.sampled_from([None, 1, 2, 3, 4]),
        st.none() | group,
    )


def _callers(
    group: st.SearchStrategy[int], calls: st.SearchStrategy[int | None] | st.SearchStrategy[int]
) -> st.SearchStrategy[Caller]:
    length = st.integers(0, 3)
    return st.builds(Caller, group, group, calls, length, length, st.booleans())


def play(system: CallingSystem) -> tuple[Diagnosed, Fate]:
    """Run a system until long after everything that can happen has happened."""
    fate = Fate()

    def program(simulation: Simulation) -> None:
        serve_outside(simulation, OUTSIDE, seconds=0.2)
        node = Node("n")
        groups = [kind() for kind in system.groups]
        make = _Maker(simulation, node, groups, len(system.services), fate)
        for number, plan in enumerate(system.services):
            make.service(number, plan)
        for number, (due, plan) in enumerate(system.timers):
            make.timer(number, due / 10, plan)
        if system.heartbeat is not None:
            make.heartbeat(groups[system.heartbeat])
        simulation.at(SECONDS - 0.5, lambda: _ask_the_scheduler(simulation, fate))
        executor = executor_of(system.threads)
        executor.add_node(node)
        executor.spin()

    return diagnosed(program, until=SECONDS), fate


class _Maker:
    """Makes the callbacks of a system."""

    def __init__(
        self, simulation: Simulation, node: Node, groups: list[CallbackGroup], services: int, fate: Fate
    ) -> None:
        self._simulation = simulation
        self._node = node
        self._groups = groups
        self._services = services
        self._fate = fate

    def service(self, number: int, plan: Caller) -> None:
        """Offer a service."""
        work = self._work(plan)
        if plan.awaits:

            async def serve_awaiting(_: object, response: object) -> object:
                await work()
                return response

            callback: Callable[..., Any] = serve_awaiting
        else:

            def serve(_: object, response: object) -> object:
                work()
                return response

            callback = serve
        callback.__name__ = f"serve_{number}"
        self._node.create_service(SetBool, f"/s{number}", callback, callback_group=self._groups[plan.group])

    def timer(self, number: int, due: float, plan: Caller) -> None:
        """Have a callback called once."""
        work = self._work(plan)
        if plan.awaits:

            async def tick_awaiting() -> None:
                timer.cancel()
                await work()

            callback: Callable[..., Any] = tick_awaiting
        else:

            def tick() -> None:
                timer.cancel()
                work()

            callback = tick
        callback.__name__ = f"tick_{number}"
        timer = self._node.create_timer(due, callback, self._groups[plan.group])

    def heartbeat(self, group: CallbackGroup) -> None:
        """Have a callback called twice a second that does nothing."""

        def beat() -> None:
            # A worker that is ended in its work begins other work before it ends.
            self._fate.heart_beats = SECONDS - 2 < self._simulation.now < SECONDS

        self._node.create_timer(0.5, beat, group)

    def _work(self, plan: Caller) -> Callable[[], Any]:
        sleep, fate = self._simulation.sleep, self._fate
        client = self._client(plan)
        calls_left = iter(range(MOST_CALLS))

        def work() -> None:
            fate.at_work += 1
            sleep(plan.before / 10)
            if client is not None and next(calls_left, None) is not None:
                client.call(SetBool.Request())
            sleep(plan.after / 10)
            fate.at_work -= 1

        async def work_awaiting() -> None:
            fate.at_work += 1
            sleep(plan.before / 10)
            if client is not None and next(calls_left, None) is not None:
                await client.call_async(SetBool.Request())
            sleep(plan.after / 10)
            fate.at_work -= 1

        return work_awaiting if plan.awaits else work

    def _client(self, plan: Caller) -> Any:
        if plan.calls is None:
            return None
        name = f"/s{plan.calls}" if plan.calls < self._services else OUTSIDE
        return self._node.create_client(SetBool, name, callback_group=self._groups[plan.client_group])


def _ask_the_scheduler(simulation: Simulation, fate: Fate) -> None:
    """No thread can run and no deadline is left but the one that ends the simulation."""
    clock = simulation.clock
    assert isinstance(clock, VirtualClock)
    alive = [
        due
        for _, order, due in clock._deadlines._heap
        if not isinstance(due, VirtualThread) or (due.waiting and due.current_wait == order)
    ]
    fate.something_can_run = bool(clock._ready) or len(alive) > 1
    fate.unfinished = fate.at_work

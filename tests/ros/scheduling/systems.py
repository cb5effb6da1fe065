"""Random systems of nodes, groups and an executor, and the play of one on virtual time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

from hypothesis import strategies as st

from sim.clock.schedule import Schedule
from sim.interfaces import message, service
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.ros.scheduling.executors import Executor, MultiThreadedExecutor, SingleThreadedExecutor
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")

GRAIN = 0.05
"""Seconds; every time of a system is a multiple of it, so that things often happen together."""
SECONDS = 2.0
TOPICS = "ab"


@dataclass(frozen=True)
class TimerPlan:
    """A timer that works for a while and may then publish, or call the service ``s`` in one way or other."""

    node: int
    group: int | None
    period: int
    length: int
    then: str


@dataclass(frozen=True)
class SubscriptionPlan:
    """A subscription whose callback works for a while."""

    node: int
    group: int | None
    topic: str
    depth: int
    length: int


@dataclass(frozen=True)
class ServicePlan:
    """A server of the service ``s`` whose callback works for a while; only the oldest is called."""

    node: int
    group: int | None
    length: int


EntityPlan: TypeAlias = TimerPlan | SubscriptionPlan | ServicePlan


@dataclass(frozen=True)
class SourcePlan:
    """A publisher in another process: ``burst`` messages each ``period`` from ``offset`` on."""

    topic: str
    offset: int
    period: int
    burst: int


@dataclass(frozen=True)
class System:
    """Lengths, periods and offsets are in grains; a group of None is the node's default group.

    At ``shutdown`` a thread of its own shuts the executor down; None: it is never shut down.
    """

    nodes: int
    groups: tuple[type[CallbackGroup], ...]
    entities: tuple[EntityPlan, ...]
    sources: tuple[SourcePlan, ...]
    threads: int | None
    shutdown: int | None = None

    @property
    def workers(self) -> int:
        """How many callbacks can run at once."""
        return self.threads or 1


def systems() -> st.SearchStrategy[System]:
    """Systems of 1 to 3 nodes and 1 to 6 entities, on 1 to 4 threads or the single-threaded executor."""
    return st.builds(_spread, st.integers(1, 3), _groups(), _entities(), _sources(), _threads())


def _spread(
    nodes: int,
    groups: tuple[type[CallbackGroup], ...],
    entities: list[EntityPlan],
    sources: list[SourcePlan],
    threads: int | None,
) -> System:
    return System(nodes, groups, tuple(entities), tuple(sources), threads)


def _groups() -> st.SearchStrategy[tuple[type[CallbackGroup], ...]]:
    kinds = st.sampled_from([MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup])
    return st.tuples(kinds, kinds)


def _entities() -> st.SearchStrategy[list[EntityPlan]]:
    node, group, length = st.integers(0, 2), st.sampled_from([None, 0, 1]), st.integers(0, 8)
    topics = st.sampled_from(TOPICS)
    then = st.sampled_from(["rest", "publish to a", "publish to b", "call", "call and wait"])
    timers = st.builds(TimerPlan, node, group, st.integers(1, 8), length, then)
    services = st.builds(ServicePlan, node, group, length)
    subscriptions = st.builds(SubscriptionPlan, node, group, topics, st.integers(1, 4), length)
    return st.lists(timers | subscriptions | services, min_size=1, max_size=6)


def _sources() -> st.SearchStrategy[list[SourcePlan]]:
    source = st.builds(
        SourcePlan, st.sampled_from(TOPICS), st.integers(0, 5), st.integers(1, 10), st.integers(1, 4)
    )
    return st.lists(source, max_size=2)


def _threads() -> st.SearchStrategy[int | None]:
    return st.sampled_from([None, 1, 2, 3, 4])


def play(system: System, schedule: Schedule | None = None) -> Trace:
    """Run a system for a while, in the order of threads that ``schedule`` chooses."""
    return simulate(program_of(system), until=SECONDS, schedule=schedule)


def program_of(system: System) -> Callable[[Simulation], None]:
    """The program that makes a system and spins it."""

    def program(simulation: Simulation) -> None:
        nodes = [Node(f"n{number}") for number in range(system.nodes)]
        groups = [kind() for kind in system.groups]
        for number, plan in enumerate(system.entities):
            node = nodes[plan.node % system.nodes]
            _make(simulation, node, plan, None if plan.group is None else groups[plan.group], number)
        for source in system.sources:
            _start(simulation, source)
        executor = (
            SingleThreadedExecutor() if system.threads is None else MultiThreadedExecutor(system.threads)
        )
        for node in nodes:
            executor.add_node(node)
        if system.shutdown is not None:
            simulation.start(_shutting_down(simulation, executor, system.shutdown), "shutting down")
        executor.spin()

    return program


def _shutting_down(simulation: Simulation, executor: Executor, grains: int) -> Callable[[], None]:
    def run() -> None:
        simulation.sleep(grains * GRAIN)
        executor.shutdown()

    return run


def _make(
    simulation: Simulation, node: Node, plan: EntityPlan, group: CallbackGroup | None, number: int
) -> None:
    def work() -> None:
        simulation.sleep(plan.length * GRAIN)

    def hear(_: object) -> None:
        work()

    def serve(_: object, response: object) -> object:
        work()
        return response

    match plan:
        case SubscriptionPlan(topic=topic, depth=depth):
            node.create_subscription(Int32, topic, _named(hear, number), depth, callback_group=group)
        case ServicePlan():
            node.create_service(SetBool, "s", _named(serve, number), callback_group=group)
        case TimerPlan(period=period, then=then):
            end = _end(node, then, group)

            def tick() -> None:
                work()
                end()

            node.create_timer(period * GRAIN, _named(tick, number), group)


def _end(node: Node, then: str, group: CallbackGroup | None) -> Callable[[], object]:
    """What a timer's callback does last; a client is in its timer's group."""
    if then.startswith("publish"):
        publisher = node.create_publisher(Int32, then[-1], 10)
        return lambda: publisher.publish(Int32())
    if then.startswith("call"):
        client = node.create_client(SetBool, "s", callback_group=group)
        if then == "call":
            return lambda: client.call_async(SetBool.Request())
        return lambda: client.call(SetBool.Request(), timeout_sec=3 * GRAIN)
    return lambda: None


def _named(callback: Callable[..., Any], number: int) -> Callable[..., Any]:
    callback.__name__ += f"_{number}"
    return callback


def _start(simulation: Simulation, source: SourcePlan) -> None:
    node = simulation.outside_node(f"source_{source.topic}")
    publisher = node.create_publisher(Int32, source.topic, 10)

    def run() -> None:
        simulation.sleep(source.offset * GRAIN)
        while True:
            for _ in range(source.burst):
                publisher.publish(Int32())
            simulation.sleep(source.period * GRAIN)

    simulation.start(run, node.get_name())

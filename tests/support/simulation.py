"""Runs a program on virtual time in a test: a host of its own, a trace in a list, no thread left."""

import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, NamedTuple, TypeVar

import sim.ros.rclpy
from sim.clock import RunClock, VirtualClock
from sim.clock.schedule import Schedule
from sim.probes.probe import Probe, PublishingProbe
from sim.releases.profile import Profile
from sim.ros.context.context import Context
from sim.ros.middleware import host as hosts
from sim.ros.middleware.host import Host
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.trace.events import (
    AnyEvent,
    CallbackEnded,
    CallbackFailed,
    CallbackStarted,
    EntityAppeared,
    EntityId,
    Logged,
    MessageDropped,
    ThreadAppeared,
)
from sim.trace.timeline import Timeline
from tests.support.builder import ns

EventT = TypeVar("EventT", bound=AnyEvent)

_PATIENCE = 60.0
"""Real seconds after which a simulation counts as stuck: a hundred times what the longest one takes."""


class Call(NamedTuple):
    """One call of a callback: when it began (seconds), which callback, and on which thread."""

    at: float
    name: str
    thread: str


class Trace:
    """The events of a finished simulation, and the questions that tests ask of them."""

    def __init__(self, events: list[AnyEvent]) -> None:
        self.events = events

    def of(self, kind: type[EventT]) -> list[EventT]:
        """The events of one kind, in order."""
        return [each for each in self.events if isinstance(each, kind)]

    @property
    def names(self) -> dict[EntityId, str]:
        """What each entity is called here: its callback's name, for a client its service's."""
        return {each.entity: each.callback or each.name for each in self.of(EntityAppeared)}

    @property
    def threads(self) -> dict[int, str]:
        """The name of each thread."""
        return {each.thread: each.name for each in self.of(ThreadAppeared)}

    def entity(self, name: str) -> EntityId:
        """The one entity of that name."""
        (found,) = (entity for entity, each in self.names.items() if each == name)
        return found

    def calls(self, name: str | None = None) -> list[Call]:
        """Every call of every callback, or of the one of that name, in order."""
        names, threads = self.names, self.threads
        every = (
            Call(each.t / 1e9, names[each.entity], threads[each.thread]) for each in self.of(CallbackStarted)
        )
        return [each for each in every if name in {None, each.name}]

    def times(self, name: str) -> list[float]:
        """When a callback's calls began, in seconds."""
        return [each.at for each in self.calls(name)]

    def ends(self, name: str) -> list[float]:
        """When a callback's calls ended, in seconds."""
        entity = self.entity(name)
        return [each.t / 1e9 for each in self.of(CallbackEnded) if each.entity == entity]

    def order(self) -> list[str]:
        """The names of the callbacks in the order of their calls."""
        return [each.name for each in self.calls()]

    def drops(self, name: str) -> int:
        """How many messages the callback's queue lost."""
        entity = self.entity(name)
        return sum(each.entity == entity for each in self.of(MessageDropped))

    def said(self) -> list[str]:
        """The texts of the log."""
        return [each.text for each in self.of(Logged)]

    def timeline(self) -> Timeline:
        """A timeline of the whole."""
        timeline = Timeline()
        timeline.extend(self.events)
        return timeline


class Simulation:
    """What a simulated program has at hand. Its context is the default one, and has begun."""

    def __init__(self, clock: RunClock, distro: str = "jazzy") -> None:
        self.events: list[AnyEvent] = []
        self.clock = clock
        self.host = Host(clock, Probe(clock, self._record), profile=Profile.named(distro))

    def _record(self, event: AnyEvent) -> None:
        if not (isinstance(event, CallbackFailed) and event.error.startswith(Ended.__name__)):
            self.events.append(event)

    @property
    def now(self) -> float:
        """Seconds since the simulation began."""
        return self.clock.now() / 1e9

    def sleep(self, seconds: float) -> None:
        """Let seconds pass on the calling thread, as ``time.sleep`` does in a program."""
        self.clock.sleep(ns(seconds))

    def sleep_until(self, seconds: float) -> None:
        """Sleep until that time of the simulation."""
        self.clock.sleep(ns(seconds) - self.clock.now())

    def at(self, seconds: float, action: Callable[[], object]) -> None:
        """Have ``action``, which must not wait, done at that time."""
        self.clock.call_at(ns(seconds), lambda: _forget(action()))

    def start(self, target: Callable[[], object], name: str = "helper") -> None:
        """Run ``target`` on one more thread."""
        self.clock.start_thread(lambda: _forget(target()), name)

    def outside_node(self, name: str = "outside") -> Node:
        """A node of another process: its own context, and only what it sends is on the trace."""
        context = Context(host=self.host, probe=PublishingProbe(self.clock, self.host.probe))
        context.init([])
        return Node(name, context=context)

    def spin_outside(self, node: Node) -> None:
        """Spin an outside node on a thread of its own."""
        executor = SingleThreadedExecutor(context=node.context)
        executor.add_node(node)
        self.start(executor.spin, node.get_name())

    def publisher_at_rate(self, topic: str, period: float, offset: float = 0.0, until: float = 1e9) -> None:
        """Have an outside node publish an Int32 that counts up from 0, each ``period`` from ``offset`` on."""
        integer = sim.interfaces.message("std_msgs", "Int32")
        node = self.outside_node(f"{topic}_publisher")
        publisher = node.create_publisher(integer, topic, 10)

        def run() -> None:
            self.sleep(offset)
            count = 0
            while self.now < until:
                publisher.publish(integer(data=count))
                count += 1
                self.sleep_until(offset + count * period)

        self.start(run, node.get_name())


Program = Callable[[Simulation], Any]


def simulate(
    program: Program, until: float = 60.0, schedule: Schedule | None = None, distro: str = "jazzy"
) -> Trace:
    """Run ``program`` on virtual time until it returns, at most until ``until`` seconds.

    ``schedule`` chooses the order of threads; without one it is first come, first served. ``distro`` is the
    release of rclpy that the model is like. Raises what the program raises; AssertionError when the
    simulation is stuck or leaves a thread.
    """
    trouble: list[BaseException] = []
    events: list[AnyEvent] = []

    def run() -> None:
        clock = EndedClock(schedule=schedule)
        simulation = Simulation(clock, distro)
        clock.time.before_jump = simulation.host.explain_waits
        clock.call_at(ns(until), clock.end)
        with installed(simulation.host):
            try:
                program(simulation)
            except KeyboardInterrupt:
                pass  # its time was up
            except BaseException as error:  # noqa: BLE001 -- it belongs to the test's own thread
                trouble.append(error)
            events.extend(simulation.events)
            clock.wind_up()

    with no_thread_left():
        main = threading.Thread(target=run, name="MainThread", daemon=True)
        main.start()
        main.join(_PATIENCE)
        assert not main.is_alive(), f"the simulation is stuck:\n{_where_threads_stand()}"
    if trouble:
        raise trouble[0]
    return Trace(events)


@contextmanager
def no_thread_left() -> Iterator[None]:
    """Check that every thread started inside has ended."""
    before = set(threading.enumerate())
    yield
    for thread in set(threading.enumerate()) - before:
        thread.join(_PATIENCE)
        assert not thread.is_alive(), f"{thread.name} was left behind:\n{_where_threads_stand()}"


class Ended(BaseException):
    """The run is over: raised out of each wait of every thread but the main one."""


class EndedClock(VirtualClock):
    """A virtual clock that can end all its threads: a test goes on after the run, an engine does not.

    At the end the main thread is interrupted, and its later waits let the others end.
    """

    def __init__(self, speed: float | None = None, schedule: Schedule | None = None) -> None:
        super().__init__(speed, schedule)
        self._is_over = self._main_knows = False

    def adopt(self, target: Callable[[], None], name: str) -> Callable[[], None]:
        """As ever, but a thread that has not begun when the run ends never does, and none tells its end."""

        def run() -> None:
            with suppress(Ended):
                if not self._is_over:
                    target()

        return super().adopt(run, name)

    def park(self, deadline: int | None) -> bool:
        """As ever, but from the end on nobody waits."""
        woken = not self._is_over and super().park(deadline)
        if not self._is_over:
            return woken
        me = self.current
        if not me.is_main:
            raise Ended
        if not self._main_knows:
            self._main_knows = True
            raise KeyboardInterrupt
        self._ready.append(me)
        self._hand_on(me)
        return False

    def end(self) -> None:
        """End the run; to be called at a time, or from the main thread."""
        self._is_over = True
        self.time.resume()
        for thread in sorted(self.threads, key=lambda each: (not each.is_main, each.current_wait)):
            self.unpark(thread)

    def wind_up(self) -> None:
        """End the run from its main thread, and let all others come to their end."""
        self._main_knows = True
        self.end()
        while len(self.threads) > 1:
            self.sleep(0)


@contextmanager
def installed(host: Host) -> Iterator[None]:
    """Have the process run on ``host``, and put all back after."""
    before = hosts._host
    hosts.install(host)
    sim.ros.rclpy.init(args=[])
    try:
        yield
    finally:
        hosts._host = before


def _forget(_result: object) -> None:
    """Take the result of something whose result nobody wants."""


def _where_threads_stand() -> str:
    names = {each.ident: each.name for each in threading.enumerate()}
    return "\n".join(
        f"{names.get(ident)}:\n{''.join(traceback.format_stack(frame)[-8:])}"
        for ident, frame in sys._current_frames().items()
    )

"""Stopping, slowing and stepping time changes when a run goes on, and nothing of what it does."""

import time
from dataclasses import dataclass
from itertools import pairwise

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.engine.commands import PaceCommand, Pause, Resume, RunUntil, SetSpeed, Step
from sim.engine.time_control import is_decision
from sim.interfaces import message
from sim.ros.node.node import Node
from sim.ros.scheduling.executors import MultiThreadedExecutor
from sim.trace.events import (
    ROBOT_THREAD,
    AnyEvent,
    CommandGiven,
    CommandKind,
    EntityReady,
    Notice,
    TimeHalted,
)
from tests.ros.scheduling.systems import SECONDS, System, play, program_of, systems
from tests.support.builder import ns
from tests.support.properties import examples
from tests.support.simulation import Program, Simulation
from tests.support.steering import Helm, steered, without_commands

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

each_system = settings(deadline=None, max_examples=examples(25), suppress_health_check=[HealthCheck.too_slow])

Int32 = message("std_msgs", "Int32")


@dataclass(frozen=True)
class Given:
    """A command, and the real microseconds before it."""

    after: int
    command: PaceCommand


def orders() -> st.SearchStrategy[list[Given]]:
    speeds = st.sampled_from([5.0, 20.0, 200.0, None])
    commands = st.one_of(
        st.just(Pause()),
        st.just(Resume()),
        st.just(Step()),
        st.builds(SetSpeed, speeds),
        st.builds(RunUntil, st.integers(0, ns(SECONDS))),
    )
    return st.lists(st.builds(Given, st.integers(0, 3000), commands), max_size=12)


def giving(given_orders: list[Given], helm: Helm) -> None:
    for order in given_orders:
        time.sleep(order.after / 1e6)
        helm.give(order.command)


@each_system
@given(systems(), orders(), st.sampled_from([20.0, None]))
def test_a_run_that_is_paused_slowed_and_stepped_at_any_time_is_the_run_that_is_not(
    system: System, given_orders: list[Given], speed: float | None
) -> None:
    events = steered(program_of(system), lambda helm: giving(given_orders, helm), SECONDS, speed)
    program = [event for event in without_commands(events) if not isinstance(event, Notice)]
    assert program == play(system).events


@each_system
@given(systems())
def test_a_run_that_is_stepped_through_is_the_run_that_is_not(system: System) -> None:
    events = steered(program_of(system), Helm.step_to_the_end, SECONDS, speed=0.001)
    assert without_commands(events) == play(system).events
    first = next(place for place, event in enumerate(events) if isinstance(event, CommandGiven))
    told = [event for event in events[first:] if not isinstance(event, CommandGiven)]
    for before, after in pairwise(told):
        if is_decision(before) and before.t < ns(SECONDS):
            assert isinstance(after, TimeHalted), before


def two_hear(simulation: Simulation) -> None:
    """A timer each second publishes to two callbacks, on two threads; one of them takes half a second."""
    node = Node("n")
    publisher = node.create_publisher(Int32, "a", 10)

    def tick() -> None:
        publisher.publish(Int32())

    def slow(_: object) -> None:
        simulation.sleep(0.5)

    def quick(_: object) -> None:
        pass

    node.create_timer(1.0, tick)
    node.create_subscription(Int32, "a", slow, 10)
    node.create_subscription(Int32, "a", quick, 10)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    executor.spin()


def decisions(events: list[AnyEvent]) -> list[tuple[float, str]]:
    """What stood last on the trace at each halt: its time and kind."""
    found = []
    for before, after in pairwise([event for event in events if not isinstance(event, CommandGiven)]):
        if isinstance(after, TimeHalted):
            kind = type(before).__name__ if before.t == after.t and is_decision(before) else "jump"
            found.append((after.t / 1e9, kind))
    return found


def test_steps_are_jumps_arrivals_starts_and_ends() -> None:
    def steering(helm: Helm) -> None:
        helm.give(Pause())
        for _ in range(8):
            helm.give(Step())
            helm.until_halted()

    found = decisions(steered(two_hear, steering, until=3.0, speed=0.001))
    assert found[:8] == [
        (1.0, "jump"),
        (1.0, "CallbackStarted"),
        (1.0, "EntityReady"),
        (1.0, "EntityReady"),
        (1.0, "CallbackEnded"),
        (1.0, "CallbackStarted"),
        (1.5, "jump"),
        (1.5, "CallbackEnded"),
    ]


def beside_a_robot(period: float) -> Program:
    """A program that sleeps beside a robot, which wakes 20 times a second."""

    def program(simulation: Simulation) -> None:
        def drive() -> None:
            while True:
                simulation.sleep(0.05)

        simulation.clock.start_thread(drive, ROBOT_THREAD)
        while True:
            simulation.sleep(period)

    return program


@pytest.mark.parametrize(("period", "halts"), [(0.62, [0.62, 1.24, 1.86]), (2.5, [1.05, 2.05, 2.5])])
def test_a_step_goes_past_what_only_the_robot_does_for_a_second_at_most(
    period: float, halts: list[float]
) -> None:
    def steering(helm: Helm) -> None:
        helm.give(Pause())
        for _ in halts:
            helm.give(Step())
            found.append(helm.until_halted().t / 1e9)

    found: list[float] = []
    steered(beside_a_robot(period), steering, until=3.0, speed=0.001)
    assert found == pytest.approx(halts, abs=0.06)


def test_steps_that_are_asked_for_at_once_are_all_taken() -> None:
    def steering(helm: Helm) -> None:
        helm.give(Pause())
        for _ in range(5):
            helm.give(Step())
        for _ in range(5):
            helm.until_halted()

    assert len(decisions(steered(two_hear, steering, until=3.0, speed=0.001))) == 5


@each_system
@given(st.lists(st.tuples(st.integers(1, 4), st.integers(0, 1500)), min_size=1, max_size=6), st.booleans())
def test_every_step_is_taken_however_many_come_before_the_first_has_halted(
    bursts: list[tuple[int, int]], awaited: bool
) -> None:
    def steering(helm: Helm) -> None:
        helm.give(Pause())
        for count, after in bursts:
            time.sleep(after / 1e6)
            for _ in range(count):
                helm.give(Step())
            if awaited:
                for _ in range(count):
                    helm.until_halted()
        if not awaited:
            for _ in range(steps):
                helm.until_halted()

    steps = sum(count for count, _ in bursts)
    events = steered(two_hear, steering, until=30.0, speed=0.001)
    assert sum(isinstance(event, TimeHalted) for event in events) == steps


def test_everything_up_to_a_moment_has_happened_when_the_run_stands_there() -> None:
    def steering(helm: Helm) -> None:
        helm.give(RunUntil(ns(1.0)))
        helm.until_halted()
        helm.give(RunUntil(ns(1.25)))
        helm.until_halted()

    events = steered(two_hear, steering, until=3.0, speed=0.001)
    first, second = (place for place, event in enumerate(events) if isinstance(event, TimeHalted))
    assert (events[first].t, events[second].t) == (ns(1.0), ns(1.25))
    assert any(isinstance(event, EntityReady) for event in events[:first])
    assert [event for event in events[first:second] if is_decision(event)] == []


def test_a_moment_that_has_passed_is_refused_in_words_and_time_goes_on_as_before() -> None:
    def steering(helm: Helm) -> None:
        helm.give(RunUntil(ns(2.0)))
        helm.until_halted()
        helm.give(RunUntil(ns(1.0)))

    events = steered(two_hear, steering, until=3.0, speed=0.001)
    (notice,) = (event for event in events if isinstance(event, Notice))
    assert notice.text == "the run has come to 2.000 s, so it cannot go on until 1 s"


def test_a_step_of_a_run_in_which_nothing_can_happen_any_more_ends_at_once() -> None:
    def nobody_sleeps(simulation: Simulation) -> None:
        signal = simulation.clock.auto_reset_event()
        signal.wait(None)

    def steering(helm: Helm) -> None:
        helm.clock.time.steer(helm.clock.time.deadlines._heap.clear)
        helm.give(Step())
        helm.until_halted()
        helm.clock.interrupt(helm.clock.current.ident)

    steered(nobody_sleeps, steering, until=1.0, speed=0.001)


def test_what_was_done_to_time_is_on_the_trace_in_words() -> None:
    def steering(helm: Helm) -> None:
        for command in (Pause(), SetSpeed(0.5), SetSpeed(None), Resume(), RunUntil(ns(2.5))):
            helm.give(command)
        helm.until_halted()

    events = steered(two_hear, steering, until=5.0, speed=0.001)
    commands = [(event.kind, event.text) for event in events if isinstance(event, CommandGiven)]
    assert commands[:5] == [
        (CommandKind.PAUSE, "pause"),
        (CommandKind.SPEED, "speed x0.5"),
        (CommandKind.SPEED, "speed max"),
        (CommandKind.RESUME, "resume"),
        (CommandKind.RUN_UNTIL, "run until 2.5 s"),
    ]
    halted = next(event for event in events if isinstance(event, TimeHalted))
    assert (halted.t, halted.text) == (ns(2.5), "run until 2.5 s")

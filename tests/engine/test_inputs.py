"""Inputs given again at their moments bring about the same run, event by event."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.clock import VirtualClock
from sim.engine.commands import (
    CallService,
    Command,
    InterruptLine,
    KeepContents,
    Pause,
    ResetWorld,
    Resume,
    RunLine,
    RunUntil,
    SetSpeed,
    Step,
    Stop,
    input_of,
    input_text,
)
from sim.engine.inputs import UnknownInputError, inputs_of, stops
from sim.engine.requests import Requests
from sim.engine.setup import RunSetup
from sim.interfaces import message
from sim.trace.events import (
    AnyEvent,
    CommandGiven,
    InputGiven,
    LineCompleted,
    LineGiven,
    Notice,
    RunEnded,
    RunStarted,
    ServiceReplied,
    TimeHalted,
    TimePassed,
    encode,
)
from tests.engine.test_pausing import Console, console
from tests.engine.test_time_control import Given, orders
from tests.ros.scheduling.systems import SECONDS, System, program_of, systems
from tests.support.builder import ns
from tests.support.engine_runs import SECOND, program_setup, run_to_end
from tests.support.properties import examples
from tests.support.simulation import Simulation, simulate
from tests.support.steering import Helm, steered

pytestmark = pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")

Int32 = message("std_msgs", "Int32")


@dataclass(frozen=True)
class Telling:
    """Something told to a run, and the real microseconds before it: a topic to publish to, or a call of s."""

    after: int
    what: str


class Keyboard:
    """Tells things to one simulation, each at the end of the moment that it has reached."""

    def __init__(self, simulation: Simulation, record: Callable[[AnyEvent], None]) -> None:
        self._clock = simulation.clock
        self._record = record
        node = simulation.outside_node("keyboard")
        self._publishers = {topic: node.create_publisher(Int32, topic, 10) for topic in "ab"}
        self._requests = Requests(simulation.host, record)

    def press(self, what: str) -> None:
        self._record(InputGiven(self._clock.now(), what))
        if what in self._publishers:
            self._publishers[what].publish(Int32())
        else:
            self._requests.set_bool(what, data=True)


def told(system: System, tellings: list[Telling | Given], speed: float | None) -> list[AnyEvent]:
    """Run a system and tell it things from outside, in real time."""
    ready = threading.Event()
    keyboards: list[Keyboard] = []
    sinks: list[Callable[[AnyEvent], None]] = []

    def record(event: AnyEvent) -> None:
        sinks[0](event)

    def program(simulation: Simulation) -> None:
        keyboards.append(Keyboard(simulation, record))
        ready.set()
        program_of(system)(simulation)

    def steering(helm: Helm) -> None:
        sinks.append(helm.record)
        assert ready.wait(60)
        for telling in tellings:
            time.sleep(telling.after / 1e6)
            if isinstance(telling, Given):
                helm.give(telling.command)
            else:
                helm.clock.time.give(lambda what=telling.what: keyboards[0].press(what))  # type: ignore[misc]

    return steered(program, steering, SECONDS, speed)


def again(system: System, recorded: list[AnyEvent]) -> list[AnyEvent]:
    """Run a system with the inputs of a run of before."""

    def program(simulation: Simulation) -> None:
        clock = simulation.clock
        assert isinstance(clock, VirtualClock)
        keyboard = Keyboard(simulation, simulation.events.append)
        for event in recorded:
            if isinstance(event, InputGiven):
                clock.time.schedule_input(event.t, lambda what=event.command: keyboard.press(what))  # type: ignore[misc]
        program_of(system)(simulation)

    return simulate(program, SECONDS).events


def of_the_run(events: list[AnyEvent]) -> list[AnyEvent]:
    """The events without what tells of the run's time."""
    return [
        event for event in events if not isinstance(event, (CommandGiven, TimeHalted, TimePassed, Notice))
    ]


def tellings() -> st.SearchStrategy[list[Telling]]:
    whats = st.sampled_from(["a", "b", "s"])
    return st.lists(
        st.builds(Telling, st.sampled_from([0, 0, 200, 1000, 4000]), whats), min_size=1, max_size=15
    )


def mixed() -> st.SearchStrategy[list[Telling | Given]]:
    return st.tuples(tellings(), orders()).flatmap(lambda both: st.permutations([*both[0], *both[1]]))


each_system = settings(deadline=None, max_examples=examples(40), suppress_health_check=[HealthCheck.too_slow])


@each_system
@given(systems(), mixed(), st.sampled_from([20.0, 100.0, 1000.0, None]))
def test_a_run_is_repeated_exactly_from_its_inputs_whenever_they_came_and_whatever_time_did(
    system: System, given_things: list[Telling | Given], speed: float | None
) -> None:
    recorded = of_the_run(told(system, given_things, speed))
    assert encode(of_the_run(again(system, recorded))) == encode(recorded)


def test_an_input_comes_when_its_moment_ends_and_after_the_effects_of_the_one_before() -> None:
    happened: list[str] = []

    def program(simulation: Simulation) -> None:
        clock = simulation.clock
        assert isinstance(clock, VirtualClock)
        signal = clock.auto_reset_event()

        def hear() -> None:
            signal.wait(None)
            happened.append("heard the first")

        def first() -> None:
            happened.append("first")
            signal.set()

        clock.start_thread(hear, "ear")
        clock.time.schedule_input(ns(1.0), first)
        clock.time.schedule_input(ns(1.0), lambda: happened.append("second"))
        for number in range(2):
            clock.call_at(ns(1.0), lambda n=number: happened.append(f"deadline {n}"))  # type: ignore[misc]
        clock.call_at(ns(1.5), lambda: happened.append("later"))
        simulation.sleep(2.0)

    simulate(program, 3.0)
    assert happened == ["deadline 0", "deadline 1", "first", "heard the first", "second", "later"]


def test_an_input_comes_while_time_stands_at_the_end_of_the_moment() -> None:
    moments: list[int] = []
    came = threading.Event()

    def program(simulation: Simulation) -> None:
        for _ in range(100):
            simulation.sleep(0.01)

    def steering(helm: Helm) -> None:
        def take() -> None:
            moments.append(helm.clock.now())
            came.set()

        helm.give(RunUntil(ns(0.5)))
        helm.until_halted()
        helm.clock.time.give(take)
        assert came.wait(60)

    steered(program, steering, until=1.0, speed=0.001)
    assert moments == [ns(0.5)]


@pytest.mark.parametrize(
    "command",
    [
        CallService(None, data=True),
        CallService("/s", data=False),
        RunLine(3, "ros2 topic list"),
        InterruptLine(3),
        ResetWorld(),
        KeepContents(wanted=True),
        Stop(),
    ],
)
def test_an_input_is_read_back_as_it_was_given(command: Command) -> None:
    assert input_of(input_text(command)) == command  # type: ignore[arg-type]


def test_an_input_of_another_version_is_refused_in_one_sentence() -> None:
    with pytest.raises(
        UnknownInputError, match=r"^this version of cbtui does not know the input given at 2\.000 s$"
    ):
        inputs_of([InputGiven(ns(2.0), '{"type":"dance"}')])


NODE = """\
import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32
from std_srvs.srv import SetBool
import time

class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(Int32, "count", 10)
        self.create_timer(0.1, self.tick)
        self.create_subscription(Int32, "count", self.hear, 3)
        self.create_service(SetBool, "switch", self.switch)
        self.count = 0

    def tick(self):
        self.count += 1
        self.publisher.publish(Int32(data=self.count))

    def hear(self, message):
        time.sleep(0.06)

    def switch(self, request, response):
        self.get_logger().info(f"switch {request.data} at {self.count}")
        time.sleep(0.35)
        return response

rclpy.init()
executor = MultiThreadedExecutor(2)
executor.add_node(Talker())
executor.spin()
"""


def _press_keys(run: Console) -> None:
    run.give(SetSpeed(20.0), CallService(None, data=True), RunLine(1, "ros2 topic echo /count"))
    run.until(ServiceReplied)
    run.give(Pause(), CallService("/switch", data=False), RunLine(2, "ros2 node list"), Resume())
    run.until(ServiceReplied, 2)
    run.give(Pause(), Step())
    run.until(TimeHalted)
    run.give(Step())
    run.until(TimeHalted, 2)
    run.give(Resume(), KeepContents(wanted=True), InterruptLine(1), RunLine(3, "ros2 topic hz /count"))
    run.until(LineGiven, 3)
    time.sleep(0.05)
    run.give(Stop())
    run.to_the_end()


def _of_the_run(events: list[AnyEvent]) -> list[AnyEvent]:
    """An engine's events without what was done to time: calls and resets stay."""
    paces = ("pause", "resume", "step", "speed", "run until")
    return [
        event
        for event in events
        if not isinstance(event, (TimeHalted, TimePassed, LineCompleted))
        and not (isinstance(event, CommandGiven) and event.text.startswith(paces))
        and not (isinstance(event, Notice) and event.text.startswith("time stands"))
    ]


def _repeated(setup: RunSetup, events: list[AnyEvent]) -> list[AnyEvent]:
    return run_to_end(msgspec.structs.replace(setup, speed=None, inputs=inputs_of(events))).events


def test_an_engine_repeats_a_run_of_calls_lines_and_interrupts_to_its_stop(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(NODE)
    setup = msgspec.structs.replace(program_setup(path, 1), until=None, speed=5.0)
    with console(setup) as run:
        _press_keys(run)
    recorded = _of_the_run(run.events)
    assert [type(input_of(each.command)) for each in inputs_of(recorded)][-1] is Stop
    assert stops(inputs_of(recorded)[-1])
    assert isinstance(recorded[0], RunStarted)
    assert isinstance(recorded[-1], RunEnded)
    assert _repeated(setup, run.events) == recorded


@pytest.mark.slow
def test_an_engine_repeats_a_robot_that_is_reset(tmp_path: Path) -> None:
    path = tmp_path / "node.py"
    path.write_text(NODE)
    setup = msgspec.structs.replace(program_setup(path, 3, robot=True), speed=10.0)
    with console(setup) as run:
        run.give(RunLine(1, "ros2 topic pub /cmd_vel geometry_msgs/msg/Twist '{linear: {x: 0.1}}'"))
        run.until(LineGiven)
        time.sleep(0.05)
        run.give(ResetWorld(), CallService("/motor_power", data=True))
        run.to_the_end()
    assert run.events[-1].t == 3 * SECOND
    assert _repeated(setup, run.events) == _of_the_run(run.events)

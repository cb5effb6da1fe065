"""Callbacks that overlap themselves, overrun their period, or sleep among sensors."""

import re
from pathlib import Path

import pytest

from sim.diagnosis import diagnose
from sim.diagnosis.rule import Rule
from sim.diagnosis.rules.services import ServiceFallsBehind
from sim.diagnosis.rules.timing import FallsBehind
from sim.diagnosis.timeline_view import TimelineView
from sim.quantities.nanoseconds import SECOND
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.trace.events import CallbackAt, CallbackEnded, CallbackStarted, Doing, TimePassed
from sim.trace.execution import Spans
from sim.trace.figures.concurrency import Concurrency
from sim.trace.model import Span, Window
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import Diagnosed, Int32, SetBool, diagnosed, executor_of, once, spin
from tests.support.builder import ns
from tests.support.engine_runs import program_setup, run_lesson, run_program, run_to_end
from tests.support.simulation import Simulation
from tests.trace.samples import CAST


def ticking(length: float, group: CallbackGroup, threads: int | None = 3) -> Diagnosed:
    """``tick`` is due each second and takes so long."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def tick() -> None:
            simulation.sleep(length)

        node.create_timer(1.0, tick, group)
        spin(node, threads)

    return diagnosed(program, until=20.0)


def test_a_timer_slower_than_its_period_overlaps_itself_in_a_reentrant_group() -> None:
    run = ticking(1.5, ReentrantCallbackGroup())
    assert run.problems() == {("overlapping-callback", "tick")}
    found = run.one("overlapping-callback")
    assert (found.at, found.lasted, found.count) == (ns(2.0), ns(0.5), 18)
    told = run.explained("overlapping-callback")
    assert told.what == "tick overlapped itself for 500 ms (18 times in all)"
    assert "where no lock guards" in told.why  # the trace does not tell whether there is one


def test_a_timer_slower_than_its_period_overruns_it_in_an_exclusive_group() -> None:
    run = ticking(1.5, MutuallyExclusiveCallbackGroup())
    assert run.problems() == {("overrun-timer", "tick")}
    told = run.explained("overrun-timer").what
    assert told == "tick took 1.5 s with a period of 1.0 s; 1 tick missed or late (12 overruns in all)"


@pytest.mark.parametrize("kind", [ReentrantCallbackGroup, MutuallyExclusiveCallbackGroup])
def test_a_timer_quicker_than_its_period_is_well(kind: type[CallbackGroup]) -> None:
    assert ticking(0.9, kind()).problems() == set()


def test_a_timer_that_overruns_now_and_then_is_a_remark() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def tick() -> None:
            simulation.sleep(2.5 if 5.0 <= simulation.now < 5.1 else 0.0)

        node.create_timer(1.0, tick)
        spin(node, None)

    run = diagnosed(program, until=20.0)
    assert run.told() == {("overrun-timer", "tick")}
    assert run.problems() == set()


def test_a_service_that_serves_two_at_once_is_a_remark() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()

        def serve(_: object, response: object) -> object:
            simulation.sleep(2.0)
            return response

        node.create_service(SetBool, "s", serve, callback_group=group)
        client = node.create_client(SetBool, "s", callback_group=group)
        once(node, 1.0, lambda: [client.call_async(SetBool.Request()) for _ in range(2)], group)
        spin(node, 3)

    run = diagnosed(program)
    assert ("overlapping-callback", "serve") in run.told()
    assert run.problems() == set()


SERVES_LOCKED = """
import time
from threading import Lock

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool


class Server(Node):
    def __init__(self):
        super().__init__("server")
        self.number = 0
        self.lock = Lock()
        group = ReentrantCallbackGroup()
        self.create_service(SetBool, "s", self.serve, callback_group=group)
        self.client = self.create_client(SetBool, "s", callback_group=group)
        self.create_timer(1.0, self.ask, callback_group=group)

    def serve(self, request, response):
        with self.lock:
            self.number += 1
        time.sleep(1.5)
        return response

    def ask(self):
        self.client.call_async(SetBool.Request())


rclpy.init()
executor = MultiThreadedExecutor(3)
executor.add_node(Server())
executor.spin()
"""


@pytest.mark.parametrize(("guard", "is_told"), [("with self.lock:", False), ("if True:", True)])
def test_calls_that_overlap_are_well_where_a_lock_guards_all_that_they_change(
    guard: str, *, is_told: bool, tmp_path: Path
) -> None:
    run = run_program(tmp_path, SERVES_LOCKED.replace("with self.lock:", guard), seconds=5.0)
    assert is_told == any(each.rule.id == "overlapping-callback" for each in diagnose(run.timeline))


def sleeper_and_sensor(*, same_group: bool, length: float = 2.0) -> Diagnosed:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        simulation.publisher_at_rate("t", 0.25, until=6.0)

        def hear(_: object) -> None: ...

        def sleeper() -> None:
            simulation.sleep(length)

        group = MutuallyExclusiveCallbackGroup()
        node.create_subscription(Int32, "t", hear, 100, callback_group=group)
        once(node, 1.0, sleeper, group if same_group else MutuallyExclusiveCallbackGroup())
        spin(node, 2)

    return diagnosed(program)


def test_a_sleep_in_a_group_shared_with_a_subscription_is_told() -> None:
    run = sleeper_and_sensor(same_group=True)
    assert run.problems() == {("group-starvation", "hear")}
    found = run.one("group-starvation")
    assert (found.at, found.until, found.culprit) == (ns(1.0), ns(3.0), run.trace.entity("sleeper"))


def test_a_sleep_in_a_group_of_its_own_is_well() -> None:
    assert sleeper_and_sensor(same_group=False).told() == set()


def test_a_short_sleep_among_sensors_is_well() -> None:
    assert sleeper_and_sensor(same_group=True, length=0.4).problems() == set()


def slow_listener(length: float, depth: int) -> Diagnosed:
    """``hear`` takes so long for each of the messages, which are 0.1 s apart."""

    def program(simulation: Simulation) -> None:
        talker, listener = Node("talker"), Node("listener")
        news = talker.create_publisher(Int32, "t", 10)

        def hear(_: object) -> None:
            simulation.sleep(length)

        listener.create_subscription(Int32, "t", hear, depth)
        talker.create_timer(0.1, lambda: news.publish(Int32()))
        executor = executor_of(2)
        for node in (talker, listener):
            executor.add_node(node)
        executor.spin()

    return diagnosed(program, until=5.0)


def test_a_callback_that_is_slower_than_its_messages_come_is_told_as_long_as_none_is_lost() -> None:
    run = slow_listener(0.3, 100)
    assert run.problems() == {("falls-behind", "hear")}
    assert run.explained("falls-behind").what == (
        "hear falls behind: it takes 300 ms a message, and took one that was 3.0 s old"
    )
    assert slow_listener(0.3, 10).problems() == {("dropped-messages", "hear")}


def test_a_burst_of_messages_that_is_served_in_turn_is_well() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        news = node.create_publisher(Int32, "t", 10)

        def hear(_: object) -> None:
            simulation.sleep(0.5)

        def burst() -> None:
            for _ in range(8):
                news.publish(Int32())

        node.create_subscription(Int32, "t", hear, 10)
        once(node, 1.0, burst, MutuallyExclusiveCallbackGroup())
        spin(node, 2)

    assert diagnosed(program).problems() == set()


@pytest.mark.parametrize("length", [0.09, 0.0])
def test_a_callback_that_keeps_up_with_its_messages_is_well(length: float) -> None:
    assert slow_listener(length, 100).problems() == set()


CALLS_TICK = """
import time
import rclpy
from rclpy.node import Node

class Worker(Node):
    def __init__(self):
        super().__init__("worker")
        self.create_timer(0.2, self.on_timer)

    def on_timer(self):
        self.tick()

    def tick(self):
        time.sleep({0})
        time.sleep({1})
        time.sleep({2})

rclpy.init()
rclpy.spin(Worker())
"""


@pytest.mark.parametrize(
    ("sleeps", "line"),
    [
        ((0.1, 0.09, 0.11), "self.tick()"),
        ((0.1, 0.11, 0.1), "self.tick()"),
        ((0.05, 0.3, 0.05), "sleep(0.3)"),
    ],
)
def test_a_long_call_is_told_at_the_line_that_took_most_of_it_or_that_led_to_such_lines(
    tmp_path: Path, sleeps: tuple[float, ...], line: str
) -> None:
    path = tmp_path / "worker.py"
    path.write_text(CALLS_TICK.format(*sleeps))
    timeline = run_to_end(program_setup(path, 3.0)).timeline
    [found] = [each for each in diagnose(timeline) if each.rule.id == "overrun-timer"]
    place = found.explained(timeline).place
    assert place is not None
    assert line in path.read_text().splitlines()[place.first_line - 1]


KEPT_LOCK = """
import threading
import time
import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor

rclpy.init()
node, lock = rclpy.create_node("n"), threading.Lock()

def count():
    with lock:
        pass

def save():
    with lock:
        time.sleep(0.45)

node.create_timer(0.1, count, MutuallyExclusiveCallbackGroup())
executor = MultiThreadedExecutor(2)
executor.add_node(node)
{other}
{spin}
"""


@pytest.mark.parametrize(
    ("other", "spin", "cure", "line"),
    [
        (
            "node.create_timer(0.5, save, MutuallyExclusiveCallbackGroup())",
            "executor.spin()",
            "let save let go of the lock before anything that takes long",
            "time.sleep(0.45)",
        ),
        (
            "threading.Thread(target=executor.spin, daemon=True).start()",
            "while True:\n    save()\n    time.sleep(0.15)",
            "let MainThread let go of the lock before anything that takes long",
            "with lock",
        ),
    ],
    ids=["a callback", "the program"],
)
def test_a_timer_is_not_said_to_be_slow_where_it_waits_for_a_lock(
    tmp_path: Path, other: str, spin: str, cure: str, line: str
) -> None:
    run = run_program(tmp_path, KEPT_LOCK.format(other=other, spin=spin))
    [found] = [each for each in diagnose(run.timeline) if each.rule.id == "overrun-timer"]
    told = found.explained(run.timeline)
    assert told.cure == cure
    assert told.why.split(" ", 2)[2].startswith(
        f"of that it waited for lock, which {cure.split()[1]} took at node.py:"
    )
    assert told.place is not None
    assert line in (tmp_path / "node.py").read_text().splitlines()[told.place.first_line - 1]


def test_what_another_call_waited_for_a_lock_is_not_part_of_a_long_call() -> None:
    timeline, sleeps, waits = Timeline(), ("node.py", "tick", 20), ("node.py", "tick", 18)
    timeline.extend(
        [
            *CAST,
            CallbackStarted(ns(0.5), 2, 1, 0, 0, 0),
            CallbackAt(ns(0.5), 2, 1, Doing.WAITS, "Lock.acquire", (waits,), lock="lock"),
            CallbackStarted(ns(1.0), 2, 2, 0, 0, 0),
            CallbackAt(ns(1.0), 2, 2, Doing.SLEEPS, "time.sleep", (sleeps,)),
            CallbackEnded(ns(1.7), 2, 2),
            TimePassed(ns(3.0)),
        ]
    )
    [found] = [each for each in diagnose(timeline) if each.rule.id == "overrun-timer"]
    told = found.explained(timeline)
    assert told.what.startswith("timer_callback took 700 ms with a period of 500 ms")
    assert "it waited for" not in told.why
    assert told.place is not None
    assert told.place.first_line == sleeps[2]


TALKS_FASTER = """
import time

import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from std_msgs.msg import Empty


def hear(_):
    time.sleep(0.5)  # too long


rclpy.init()
node = rclpy.create_node("slow")
news = node.create_publisher(Empty, "t", 10)
node.create_timer(0.1, lambda: news.publish(Empty()), callback_group=MutuallyExclusiveCallbackGroup())
node.create_subscription(Empty, "t", hear, {depth})
executor = MultiThreadedExecutor(2)
executor.add_node(node)
executor.spin()
"""


@pytest.mark.parametrize(("depth", "rule"), [(20, "dropped-messages"), (100, "falls-behind")])
def test_what_is_too_slow_for_its_messages_is_told_at_the_line_that_takes_the_time(
    tmp_path: Path, depth: int, rule: str
) -> None:
    path = tmp_path / "slow.py"
    path.write_text(TALKS_FASTER.format(depth=depth))
    timeline = run_to_end(program_setup(path, 4.0)).timeline
    [found] = [each for each in diagnose(timeline) if each.rule.id == rule]
    told, place = found.explained(timeline), found.explained(timeline).place
    assert re.search(
        r"(took one that was|what hear took then was up to) [12]\.\d s old", f"{told.what} {told.why}"
    )
    assert place is not None
    assert "too long" in path.read_text().splitlines()[place.first_line - 1]


def test_a_timer_that_awaits_longer_than_its_period_overruns_it_as_one_that_waits_in_call() -> None:
    timeline = run_lesson("three-cures", 8.0).timeline
    found = [each for each in diagnose(timeline) if each.rule.id == "overrun-timer"]
    cures = {timeline.entities[each.subject].callback: each.explained(timeline).cure for each in found}
    assert cures == {
        name: f"return from {name}, and go on in a done-callback of the future{which}"
        for name, which in (("ask_and_await", ""), ("ask_and_wait", ", which call_async() returns"))
    }


@pytest.mark.parametrize(
    ("period", "told"), [(500.0, "0.5"), (1000.0, "1"), (300.0, ""), (99.0, ""), (0.5, "")]
)
def test_a_period_of_hundreds_of_seconds_may_be_meant_in_milliseconds(period: float, told: str) -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        node.create_timer(period, lambda: None)
        spin(node, None)

    run = diagnosed(program, until=3.0)
    assert run.problems() == set()
    cures = [each.explained(run.timeline).cure for each in run.findings]
    assert cures == ([f"if milliseconds are meant, give it {told}"] if told else [])


@pytest.mark.parametrize(("requests", "every"), [(6, 0.0), (6, 1.5)], ids=["burst", "slower than it answers"])
def test_a_service_that_answers_what_it_was_asked_in_turn_does_not_fall_behind(
    requests: int, every: float
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "/own", callback_group=MutuallyExclusiveCallbackGroup())

        def serve(_: object, response: object) -> object:
            simulation.sleep(1.2)
            return response

        node.create_service(SetBool, "/own", serve, callback_group=MutuallyExclusiveCallbackGroup())
        for number in range(requests):
            once(node, 0.5 + every * number, lambda: client.call_async(SetBool.Request()))
        spin(node, 3)

    assert diagnosed(program).problems() == set()


@pytest.mark.parametrize("rule", [ServiceFallsBehind(), FallsBehind()], ids=["service", "subscription"])
def test_what_falls_behind_is_looked_for_in_the_latest_calls_alone(
    rule: Rule, monkeypatch: pytest.MonkeyPatch
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        client = node.create_client(SetBool, "/own", callback_group=MutuallyExclusiveCallbackGroup())
        publisher = node.create_publisher(Int32, "numbers", 1000)

        def work(_: object) -> None:
            simulation.sleep(1.2 if simulation.now > 100 else 0.3)

        def serve(_: object, response: object) -> object:
            work(response)
            return response

        def ask() -> None:
            client.call_async(SetBool.Request())
            publisher.publish(Int32())

        groups = [MutuallyExclusiveCallbackGroup() for _ in range(3)]
        node.create_service(SetBool, "/own", serve, callback_group=groups[0])
        node.create_subscription(Int32, "numbers", work, 1000, callback_group=groups[1])
        node.create_timer(0.5, ask, callback_group=groups[2])
        spin(node, 4)

    run = diagnosed(program, until=108.0).timeline
    reads: list[int] = []
    read_span = Spans.span

    def span(spans: Spans, row: int) -> Span:
        reads.append(row)
        return read_span(spans, row)

    monkeypatch.setattr(Spans, "span", span)
    lately = Window(run.end - 3 * SECOND, run.end + 1)
    assert list(rule.check(TimelineView(run, lately, Concurrency(run))))
    assert len(reads) < 50


def two_timers(
    lengths: tuple[float, float], *, apart: bool, threads: int | None, other_period: float = 0.1
) -> Diagnosed:
    """``left`` and ``right`` take so long, each in its period."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def left() -> None:
            simulation.sleep(lengths[0])

        def right() -> None:
            simulation.sleep(lengths[1])

        first = MutuallyExclusiveCallbackGroup()
        node.create_timer(0.1, left, first)
        node.create_timer(other_period, right, MutuallyExclusiveCallbackGroup() if apart else first)
        spin(node, threads)

    return diagnosed(program)


@pytest.mark.parametrize(
    ("apart", "threads", "whose", "cure"),
    [
        (False, None, "the only thread", "give right a callback group of its own, and spin with "),
        (True, None, "the only thread", "spin with MultiThreadedExecutor(num_threads=2); or let left"),
        (False, 4, "group A", "give right a callback group of its own; or let left and right take less time"),
    ],
)
def test_timers_that_ask_for_more_than_all_of_the_time_are_told_with_what_they_ask_for(
    apart: bool, threads: int | None, whose: str, cure: str
) -> None:
    run = two_timers((0.06, 0.07), apart=apart, threads=threads)
    assert {rule for rule, _ in run.problems()} == {"overload"}
    told = run.explained("overload")
    assert told.what.startswith(f"left and right ask for 130 % of the time of {whose}: ")
    assert told.what.endswith(" Hz in place of 10 Hz")
    assert told.why.endswith("; left takes 60 ms every 100 ms and right takes 70 ms every 100 ms")
    assert told.cure.startswith(cure)


@pytest.mark.parametrize(
    ("lengths", "what", "cure"),
    [
        ((0.06, 0.07), "tick and hear ask for 130 %", "give hear a callback group of its own, and spin "),
        ((0.0, 0.12), "hear asks for 120 %", "let hear take less time, or timers be due less often"),
    ],
)
def test_a_subscription_that_hears_a_timer_asks_for_as_much_as_at_each_of_its_calls(
    lengths: tuple[float, float], what: str, cure: str
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "/n", 10)

        def tick() -> None:
            simulation.sleep(lengths[0])
            publisher.publish(Int32(data=1))

        def hear(_: object) -> None:
            simulation.sleep(lengths[1])

        node.create_timer(0.1, tick)
        node.create_subscription(Int32, "/n", hear, 10)
        spin(node, None)

    run = diagnosed(program)
    assert {rule for rule, _ in run.problems()} == {"overload"}
    told = run.explained("overload")
    assert told.what.startswith(f"{what} of the time of the only thread: tick comes at ")
    assert told.cure.startswith(cure)


@pytest.mark.parametrize(
    ("lengths", "other_period", "apart", "threads"),
    [
        ((0.04, 0.05), 0.1, False, None),
        ((0.07, 0.08), 0.1, True, 2),
        ((0.07, 0.08), 0.4, False, None),
    ],
    ids=["time enough", "each on a thread", "seldom"],
)
def test_timers_that_have_time_enough_ask_for_nothing(
    lengths: tuple[float, float], other_period: float, apart: bool, threads: int | None
) -> None:
    run = two_timers(lengths, apart=apart, threads=threads, other_period=other_period)
    assert run.problems() == set()

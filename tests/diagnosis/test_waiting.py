"""Callbacks that are ready and do not run: for their group, for a thread, for somebody to spin."""

from pathlib import Path

import pytest

import sim.ros.rclpy as rclpy
from sim.diagnosis import diagnose
from sim.diagnosis.rule import Weight
from sim.quantities.durations import duration
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from sim.ros.scheduling.events_executor import EventsExecutor
from sim.ros.scheduling.executors import SingleThreadedExecutor
from sim.trace.figures.summary import summarise
from tests.diagnosis.findings import Diagnosed, Int32, diagnosed, once, spin
from tests.support.builder import ns
from tests.support.engine_runs import run_lesson, run_program
from tests.support.simulation import Simulation


def slow_and_quick(
    *, same_group: bool, threads: int | None, length: float = 3.0, idle: bool = False
) -> Diagnosed:
    """``slow`` works from 1 s on; ``quick`` is due 0.1 s later; another executor may be ``idle``."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(length)

        def quick() -> None: ...

        first = MutuallyExclusiveCallbackGroup()
        once(node, 1.0, slow, first)
        once(node, 1.1, quick, first if same_group else MutuallyExclusiveCallbackGroup())
        if idle:
            SingleThreadedExecutor()
        spin(node, threads)

    return diagnosed(program)


def test_a_callback_that_waits_long_for_its_group_is_starved_by_who_holds_it() -> None:
    run = slow_and_quick(same_group=True, threads=2)
    assert run.problems() == {("group-starvation", "quick")}
    found = run.one("group-starvation")
    assert (found.at, found.until, found.count) == (ns(1.1), ns(4.0), 1)
    assert found.culprit == run.trace.entity("slow")
    told = run.explained("group-starvation")
    assert told.what == "quick waited 2.9 s: group A was held by slow"
    assert told.place is not None
    assert told.place.file == __file__


def test_callbacks_of_one_name_are_told_apart_by_their_nodes_or_topics() -> None:
    def program(simulation: Simulation) -> None:
        def long(_message: object = None) -> None:
            simulation.sleep(3.0)

        def short(_message: object = None) -> None: ...

        long.__name__ = short.__name__ = "callback"
        one, other = Node("one"), Node("other")
        once(one, 1.0, long)
        once(other, 1.1, short)
        executor = SingleThreadedExecutor()
        executor.add_node(one)
        executor.add_node(other)
        executor.spin()

    told = diagnosed(program).explained("no-free-worker").what
    assert told == "callback (/other) waited 2.9 s: the only thread ran callback (/one)"


def test_with_one_thread_the_cure_of_a_held_group_names_a_thread_too() -> None:
    told = slow_and_quick(same_group=True, threads=None).explained("group-starvation")
    assert "MultiThreadedExecutor(num_threads=2)" in told.cure


def test_who_holds_a_group_leaves_it_if_others_would_be_left_behind() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def early() -> None: ...

        def slow() -> None:
            simulation.sleep(3.0)

        def quick() -> None: ...

        once(node, 0.5, early)
        once(node, 1.0, slow)
        once(node, 1.1, quick)
        spin(node, 2)

    told = diagnosed(program).explained("group-starvation")
    assert told.what == "quick waited 2.9 s: group A was held by slow"
    assert told.cure.startswith("give slow a callback group of its own")
    alone = slow_and_quick(same_group=True, threads=2).explained("group-starvation")
    assert alone.cure.startswith("give quick a callback group of its own")


def test_a_callback_whose_group_is_free_waits_long_for_a_thread() -> None:
    run = slow_and_quick(same_group=False, threads=None)
    assert run.problems() == {("no-free-worker", "quick")}
    assert run.explained("no-free-worker").what == "quick waited 2.9 s: the only thread ran slow"
    beside_another = slow_and_quick(same_group=False, threads=None, idle=True)
    assert beside_another.explained("no-free-worker").what == "quick waited 2.9 s: its only thread ran slow"


def test_who_waits_for_the_thread_of_a_callback_that_holds_a_group_is_told_with_the_group() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(3.0)

        def quick() -> None: ...

        def other() -> None: ...

        once(node, 1.0, slow)
        once(node, 1.1, quick)
        once(node, 1.2, other, MutuallyExclusiveCallbackGroup())
        spin(node, None)

    run = diagnosed(program)
    assert run.problems() == {("group-starvation", "quick")}
    told = run.explained("group-starvation")
    assert told.what == "quick and other waited up to 2.9 s: group A was held by slow, on the only thread"
    assert told.cure.startswith("give slow a callback group of its own, and spin with MultiThreaded")


def test_calls_of_one_callback_on_all_threads_are_no_reason_for_one_thread_more() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def count(_: object) -> None:
            simulation.sleep(2.0)

        def quick() -> None: ...

        group = ReentrantCallbackGroup()
        node.create_subscription(Int32, "t", count, 10, callback_group=group)
        publisher = node.create_publisher(Int32, "t", 10)
        for _ in range(3):
            publisher.publish(Int32())
        once(node, 0.5, quick)
        spin(node, 3)

    run = diagnosed(program)
    assert run.one("no-free-worker").culprit == run.trace.entity("count")
    told = run.explained("no-free-worker")
    assert told.what == "quick waited 1.5 s: all 3 threads ran count"
    # Nothing about locks, as none is waited for.
    assert told.cure == (
        "give count a MutuallyExclusiveCallbackGroup: then its calls wait outside, without a thread"
    )


def test_calls_that_wait_for_a_lock_are_told_where_they_wait() -> None:
    timeline = run_lesson("lock-or-group", 6.0).timeline
    [found] = [each for each in diagnose(timeline) if each.rule.id == "no-free-worker"]
    assert found.explained(timeline).cure == (
        "give count_with_lock a MutuallyExclusiveCallbackGroup: then its calls wait outside, "
        "without a thread; for a lock they wait inside, and one more thread would wait there too"
    )


SAVES_UNDER_A_LOCK = """
import threading
import time

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor


def fast():
    with lock:
        pass


def save():
    with lock:
        time.sleep(1.2)


rclpy.init()
node, lock, group = rclpy.create_node("n"), threading.Lock(), ReentrantCallbackGroup()
node.create_timer(0.1, fast, callback_group=group)
node.create_timer(2.0, save, callback_group=group)
executor = MultiThreadedExecutor(4)
executor.add_node(node)
executor.spin()
"""


@pytest.mark.parametrize("clock", ["virtual", "real"])
def test_threads_that_wait_for_a_lock_are_no_reason_for_one_thread_more(clock: str, tmp_path: Path) -> None:
    timeline = run_program(tmp_path, SAVES_UNDER_A_LOCK, 4.0, clock).timeline
    told = {each.rule.id: (each.weight_in(timeline), each.explained(timeline)) for each in diagnose(timeline)}
    weight, busy = told["no-free-worker"]
    assert weight is Weight.REMARK
    assert "save held a lock for which fast waited, and no thread was free" in busy.what
    assert busy.cure.startswith("in save, keep the lock only")


def test_groups_of_their_own_and_two_threads_are_well() -> None:
    assert slow_and_quick(same_group=False, threads=2).told() == set()


@pytest.mark.parametrize("same_group", [True, False])
def test_in_an_event_queue_no_group_of_its_own_helps(same_group: bool) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(3.0)

        def quick() -> None: ...

        first = MutuallyExclusiveCallbackGroup()
        once(node, 1.0, slow, first)
        once(node, 1.1, quick, first if same_group else MutuallyExclusiveCallbackGroup())
        rclpy.spin(node, EventsExecutor())

    run = diagnosed(program)
    assert run.problems() == {("behind-others", "quick")}
    told = run.explained("behind-others")
    assert told.what == "quick waited 2.9 s: the EventsExecutor was running slow"
    assert told.cure.startswith("keep slow short, or let a MultiThreadedExecutor")
    assert ("group of its own" in told.cure) is same_group


@pytest.mark.parametrize("same_group", [True, False])
def test_short_waits_are_no_problem(same_group: bool) -> None:
    run = slow_and_quick(same_group=same_group, threads=None, length=0.5)
    assert run.problems() == set()


def test_waits_that_repeat_are_one_finding_with_the_longest() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(simulation.now / 2)

        def quick() -> None: ...

        group = MutuallyExclusiveCallbackGroup()
        for at in (2.0, 10.0, 4.0):
            once(node, at, slow, group)
            once(node, at + 0.25, quick, group)
        spin(node, None)

    run = diagnosed(program, until=20.0)
    worst = max((each for each in run.findings if each.rule.id == "group-starvation"), key=lambda f: f.size)
    assert worst.lasted == ns(4.75)


def test_only_the_waits_of_the_callback_that_is_named_are_counted() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def slow() -> None:
            simulation.sleep(2.0)

        def quick() -> None: ...

        def other() -> None: ...

        node.create_timer(5.0, slow)
        node.create_timer(5.1, quick)
        once(node, 10.5, other)
        spin(node, None)

    told = diagnosed(program, until=18.0).explained("group-starvation")
    assert told.what == "quick waited 1.9 s: group A was held by slow (3 times in all)"


def test_a_callback_that_waits_for_itself_alone_is_not_starved() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def hear(_: object) -> None:
            simulation.sleep(2.0)

        node.create_subscription(Int32, "t", hear, 10)
        publisher = node.create_publisher(Int32, "t", 10)
        for _ in range(3):
            publisher.publish(Int32())
        spin(node, 2)

    assert diagnosed(program).problems() == set()


def test_a_node_that_nobody_ever_spins_is_told() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("forgotten")

        def tick() -> None: ...

        node.create_timer(1.0, tick)
        simulation.sleep(5.0)

    run = diagnosed(program)
    assert run.problems() == {("node-never-spins", "tick")}
    told = run.explained("node-never-spins").what
    assert told == "tick of /forgotten has been ready for 4.0 s and does not run: nobody ever spun its node"


def test_a_node_whose_executor_is_made_and_never_spun_is_told_so() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("forgotten")

        def tick() -> None: ...

        node.create_timer(1.0, tick)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        simulation.sleep(5.0)

    run = diagnosed(program)
    assert run.problems() == {("node-never-spins", "tick")}
    told = run.explained("node-never-spins")
    assert told.what.endswith("does not run: none of the spinning executors has its node")
    assert told.cure == (
        "add the node to an executor that spins: one that is only made runs nothing, "
        "and a second spin() is not reached before the first one returns"
    )


def test_a_node_that_is_spun_no_more_is_told() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        rclpy.spin_once(node)
        simulation.sleep(5.0)

    run = diagnosed(program)
    assert run.problems() == {("node-never-spins", "<lambda>")}
    assert run.explained("node-never-spins").what.endswith("nobody spins its node any more")


@pytest.mark.parametrize(
    ("seconds", "timeout", "waited"), [(0.25, 0.0, "waited up to"), (1.2, 0.05, "waited")]
)
def test_a_loop_that_spins_too_rarely_is_told_with_the_longest_wait_of_the_table(
    seconds: float, timeout: float, waited: str
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        publisher = node.create_publisher(Int32, "t", 10)
        node.create_timer(0.1, lambda: publisher.publish(Int32()))
        if not timeout:
            node.create_subscription(Int32, "t", lambda _: None, 10)
        while simulation.clock.now() < ns(5.3):
            rclpy.spin_once(node, timeout_sec=timeout)
            simulation.sleep(seconds)

    run = diagnosed(program, 5.3)
    waits = [each.longest_wait for each in summarise(run.timeline).callbacks]
    longest = max(each.length for each in waits if each is not None)
    assert f" {waited} {duration(longest)}: " in run.explained("spins-too-rarely").what


def test_a_node_that_is_spun_after_a_while_is_well() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: None)
        simulation.sleep(5.0)
        rclpy.spin(node)

    assert diagnosed(program).told() == set()


def kept_late(period: float, length: float, every: float) -> Diagnosed:
    """``often`` is due each period; ``slow`` of the same group works so long, each so many seconds."""

    def program(simulation: Simulation) -> None:
        node = Node("n")

        def often() -> None: ...

        def slow() -> None:
            simulation.sleep(length)

        node.create_timer(period, often)
        node.create_timer(every, slow)
        spin(node, 4)

    return diagnosed(program, 20.0)


@pytest.mark.parametrize(
    ("period", "length", "every", "waited"),
    [(0.05, 0.3, 0.31, "290 ms"), (0.1, 0.45, 0.5, "350 ms")],
    ids=["at most calls", "at every other call"],
)
def test_a_timer_that_misses_ticks_at_many_calls_is_starved(
    period: float, length: float, every: float, waited: str
) -> None:
    run = kept_late(period, length, every)
    assert ("group-starvation", "often") in run.problems()
    assert f"often waited {waited}: group A was held by slow (" in run.explained("group-starvation").what


@pytest.mark.parametrize(
    ("period", "length", "every"),
    [(0.05, 0.3, 5.0), (0.2, 0.3, 0.31), (0.001, 0.04, 0.041)],
    ids=["at few calls", "by less than two periods", "for a moment"],
)
def test_a_timer_that_is_late_now_and_then_or_for_a_moment_is_well(
    period: float, length: float, every: float
) -> None:
    assert kept_late(period, length, every).problems() == set()


@pytest.mark.parametrize(
    ("length", "stops", "told"),
    [
        (0.4, False, "; it comes at 13.3 Hz in place of 20 Hz"),
        (0.4, True, ""),
        (0.12, False, ""),
    ],
    ids=["by a third", "stops meanwhile", "by a tenth"],
)
def test_a_timer_that_seldom_waits_but_comes_too_seldom_by_that_is_worth_a_remark_with_both_rates(
    length: float, stops: bool, told: str
) -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def often() -> None: ...

        def slow() -> None:
            simulation.sleep(length)

        timer = node.create_timer(0.05, often)
        node.create_timer(1.0, slow)
        if stops:
            once(node, 10.05, timer.cancel)
            once(node, 17.05, timer.reset)
        spin(node, None)

    run = diagnosed(program, 20.0)
    assert run.problems() == set()
    assert run.told() == ({("group-starvation", "often")} if told else set())
    if told:
        told = f"often waited 350 ms: group A was held by slow (19 times in all){told}"
        assert run.explained("group-starvation").what == told


WAITS_IN_A_TASK = """
import time
import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import SetBool

class N(Node):
    def __init__(self):
        super().__init__("n")
        self.create_service(SetBool, "lamp", lambda request, response: response)
        self.client = self.create_client(SetBool, "lamp")
        self.create_timer(1.0, self.ask)

    def ask(self):
        self.client.call_async(SetBool.Request()).add_done_callback(self.answered)

    def answered(self, future):
        WAIT

rclpy.init()
rclpy.spin(N())
"""


def test_a_thread_that_a_done_callback_keeps_runs_that(tmp_path: Path) -> None:
    timeline = run_program(tmp_path, WAITS_IN_A_TASK.replace("WAIT", "time.sleep(1.8)"), 6.0).timeline
    (told,) = (each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "no-free-worker")
    assert "the only thread ran answered" in told.what
    assert str(told.place) == "node.py:19"


def test_a_done_callback_that_waits_for_a_reply_on_the_only_thread_is_a_deadlock(tmp_path: Path) -> None:
    source = WAITS_IN_A_TASK.replace("WAIT", "self.client.call(SetBool.Request())")
    timeline = run_program(tmp_path, source, 6.0).timeline
    (found,) = (each for each in diagnose(timeline) if each.rule.id == "self-made-deadlock")
    told = found.explained(timeline)
    assert told.what.startswith("deadlock: answered waits for /lamp for ever; /lamp needs the only thread")
    assert told.cure == (
        "use call_async() and return from answered, or keep it, and spin with "
        "MultiThreadedExecutor(num_threads=2)"
    )
    assert str(told.place) == "node.py:19"


def test_a_task_that_waits_for_what_the_only_thread_would_run_is_said_to(tmp_path: Path) -> None:
    source = WAITS_IN_A_TASK.replace("WAIT", "self.done.wait(1.8)").replace("import time", "import threading")
    beats = "self.create_timer(0.3, self.beat)\n        self.done = threading.Event()"
    source = source.replace("    def ask", "    def beat(self):\n        self.done.set()\n\n    def ask")
    source = source.replace("self.create_timer(1.0", f"{beats}\n        self.create_timer(1.0")
    source = source.replace(
        "def answered(self, future):\n", "def answered(self, future):\n        self.done.clear()\n"
    )
    timeline = run_program(tmp_path, source, 6.0).timeline
    (told,) = (each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "no-free-worker")
    assert told.why.endswith(", and answered waits for what beat sets")
    assert told.cure == "spin with MultiThreadedExecutor(num_threads=2)"


def test_a_callback_that_awaits_what_came_often_does_not_await_in_vain(tmp_path: Path) -> None:
    source = (
        "import time, rclpy",
        "from rclpy.node import Node",
        "class Worker(Node):",
        "    def __init__(self):",
        "        super().__init__('worker')",
        "        self.create_timer(1.0, self.go)",
        "        self.create_timer(0.5, self.beat)",
        "    def work(self): time.sleep(3.0)",
        "    async def go(self): await self.executor.create_task(self.work)",
        "    def beat(self): pass",
        "rclpy.init()",
        "rclpy.spin(Worker())",
    )
    timeline = run_program(tmp_path, "\n".join(source), 9.2).timeline
    (told,) = (each.explained(timeline) for each in diagnose(timeline) if each.rule.id == "group-starvation")
    assert told.what.endswith(" s: group A was held by go")
    assert "a callback group of its own, and spin with MultiThreadedExecutor(num_threads=2)" in told.cure

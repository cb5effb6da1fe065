"""Calls whose reply cannot come as long as they wait for it."""

import linecache
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from sim.diagnosis import diagnose
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import (
    CallbackGroup,
    MutuallyExclusiveCallbackGroup,
    ReentrantCallbackGroup,
)
from sim.trace.events import EntityAppeared, EntityKind
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import Diagnosed, SetBool, diagnosed, once, serve_outside, spin
from tests.support.builder import ns
from tests.support.engine_runs import program_setup, run_program, run_to_end
from tests.support.runs import Run
from tests.support.simulation import Simulation

Group = Callable[[], CallbackGroup]

PROGRAMS = Path(__file__).parent / "beginners"


def callers(count: int, threads: int | None, group: Group, timeout: float | None = None) -> Diagnosed:
    """``caller`` is so many timers that at 1 s call a service of another process."""

    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        for number in range(count):
            client = node.create_client(SetBool, "/outside", callback_group=group())

            def caller(client: object = client) -> None:
                client.call(SetBool.Request(), timeout_sec=timeout)  # type: ignore[attr-defined]

            caller.__name__ += f"_{number}"
            once(node, 1.0, caller, group())
        spin(node, threads)

    return diagnosed(program)


def shared(kind: type[CallbackGroup]) -> Group:
    group = kind()
    return lambda: group


def test_caller_and_client_in_one_exclusive_group_are_a_deadlock() -> None:
    run = callers(1, 2, shared(MutuallyExclusiveCallbackGroup))
    assert run.problems() == {("self-made-deadlock", "caller_0")}
    found = run.one("self-made-deadlock")
    assert (found.at, found.until) == (ns(1.0), run.timeline.end)
    assert found.ring == ("caller_0", "/outside", "group A", "caller_0")
    assert run.explained("self-made-deadlock").what == (
        "deadlock: caller_0 waits for /outside for ever; "
        "the reply of /outside waits for group A, which caller_0 holds"
    )


@pytest.mark.filterwarnings("ignore:MultiThreadedExecutor is used with a single thread")
@pytest.mark.parametrize("threads", [None, 1])
def test_a_call_on_the_only_thread_is_a_deadlock_whatever_the_groups(threads: int | None) -> None:
    run = callers(1, threads, MutuallyExclusiveCallbackGroup)
    assert run.problems() == {("self-made-deadlock", "caller_0")}
    assert "needs the only thread, which caller_0 keeps" in run.explained("self-made-deadlock").what


@pytest.mark.parametrize("count", [2, 3])
@pytest.mark.parametrize("kind", [MutuallyExclusiveCallbackGroup, shared(ReentrantCallbackGroup)])
def test_as_many_calls_as_threads_need_one_thread_more(count: int, kind: Group) -> None:
    run = callers(count, count, kind)
    assert {rule for rule, _ in run.problems()} == {"needs-one-more-worker"}
    told = run.explained("needs-one-more-worker")
    assert f"{'both' if count == 2 else f'all {count}'} stand still: " in told.what
    assert f"num_threads={count + 1}" in told.cure


@pytest.mark.parametrize(
    ("kind", "rule"),
    [
        (shared(ReentrantCallbackGroup), "needs-one-more-worker"),
        (shared(MutuallyExclusiveCallbackGroup), "self-made-deadlock"),
    ],
)
def test_of_a_service_that_calls_itself_no_number_of_threads_and_no_group_is_offered(
    kind: Group, rule: str
) -> None:
    def program(simulation: Simulation) -> None:
        node, group = Node("n"), kind()
        client = node.create_client(SetBool, "again", callback_group=group)

        def serve(_: object, response: object) -> object:
            client.call(SetBool.Request())
            return response

        node.create_service(SetBool, "again", serve, callback_group=group)
        once(node, 1.0, lambda: client.call_async(SetBool.Request()), ReentrantCallbackGroup())
        spin(node, 3)

    told = diagnosed(program).explained(rule)
    assert told.why.startswith("serve calls its own service")
    assert told.cure == "let serve call itself as a function; no number of threads is enough for every depth"
    assert not told.remedies


def test_a_goal_awaited_in_the_group_of_its_client_is_a_deadlock_even_if_its_reply_is_seen_late() -> None:
    run, client = Run(), 9
    run.executor("MultiThreadedExecutor", 4)
    node = run.node("/n")
    group, thread = run.exclusive(node), run.thread("MainThread")
    run.add(
        EntityAppeared(0, client, node, group, EntityKind.WAITABLE, "/turn client", "", "node.py", 1, 1, 0, 0)
    )
    ask = run.timer(group, "ask", 1.0)
    run.start(ask, thread, 1.0)
    run.call("/turn/_action/send_goal", 1.0, 1.02, entity=ask)
    run.suspend(ask, thread, 1.0)
    run.wait(client, 1.03, holder=ask)
    run.stop(9.0)
    timeline = Timeline()
    timeline.extend(run.events)
    (found,) = diagnose(timeline)
    assert found.explained(timeline).what == (
        "deadlock: ask waits for /turn/_action/send_goal for ever; "
        "the reply of /turn/_action/send_goal waits for group A, which ask holds"
    )


def test_one_thread_more_is_not_advised_alone_where_a_group_keeps_out_an_answer_too(tmp_path: Path) -> None:
    text = (PROGRAMS / "calls_of_two_peers.py").read_text()
    own = "callback_group=group if name == 'left' else None"
    (tmp_path / "peers.py").write_text(text.replace("self.tick", f"self.tick, {own}"))
    run = run_to_end(program_setup(tmp_path / "peers.py", 4.0))
    found = diagnose(run.timeline)[0]
    assert found.rule.id == "needs-one-more-worker"
    assert found.explained(run.timeline).cure == (
        "give tick (/right) a callback group of its own, and spin with MultiThreadedExecutor(num_threads=3), "
        "or use call_async()"
    )


def test_one_callback_on_all_threads_is_named_once_for_the_requests_and_replies_of_its_service() -> None:
    run = run_to_end(program_setup(PROGRAMS / "call_in_reentrant_timer.py", 4.0))
    found = diagnose(run.timeline)[0]
    assert found.explained(run.timeline).what == (
        "deadlock: toggle waits for /light for ever; /light needs a thread, and both stand still in toggle "
        "(call_in_reentrant_timer.py:26)"
    )


@pytest.mark.parametrize("count", [1, 2, 3])
def test_one_thread_more_than_calls_is_well(count: int) -> None:
    assert callers(count, count + 1, MutuallyExclusiveCallbackGroup).problems() == set()


def test_a_deadlock_that_a_timeout_ended_is_told_as_over() -> None:
    run = callers(1, 2, shared(MutuallyExclusiveCallbackGroup), timeout=2.0)
    assert ("self-made-deadlock", "caller_0") in run.problems()
    found = run.one("self-made-deadlock")
    assert (found.at, found.until) == (ns(1.0), ns(3.0))
    assert run.explained("self-made-deadlock").what.startswith("caller_0 waited in vain for /outside;")


def test_a_long_answer_is_no_deadlock() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation, seconds=4.0)
        node = Node("n")
        client = node.create_client(SetBool, "/outside", callback_group=MutuallyExclusiveCallbackGroup())
        once(node, 1.0, lambda: client.call(SetBool.Request()))
        spin(node, 2)

    assert diagnosed(program).problems() == set()
    assert diagnosed(program, until=3.0).problems() == set()


def test_services_that_call_each_other_in_a_circle_are_spelt_out() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def offer(name: str, other: str) -> Callable[[object, object], object]:
            client = node.create_client(SetBool, other, callback_group=MutuallyExclusiveCallbackGroup())

            def serve(_: object, response: object) -> object:
                client.call(SetBool.Request())
                return response

            serve.__name__ = f"serve_{name}"
            node.create_service(SetBool, name, serve, callback_group=MutuallyExclusiveCallbackGroup())
            return serve

        offer("a", "b")
        offer("b", "a")
        client = node.create_client(SetBool, "a", callback_group=MutuallyExclusiveCallbackGroup())
        once(node, 1.0, lambda: client.call_async(SetBool.Request()))
        spin(node, 8)

    run = diagnosed(program)
    assert run.problems() == {("self-made-deadlock", "serve_a")}
    what = run.explained("self-made-deadlock").what
    assert what.startswith(
        "deadlock: serve_a waits for /b for ever; /b is answered by serve_b; /a waits for "
    )
    assert what.endswith("which serve_a holds")
    assert run.one("self-made-deadlock").ring[:4] == ("serve_a", "/b", "serve_b", "/a")


@pytest.mark.parametrize("kind", [MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup])
@pytest.mark.parametrize(("first", "last"), [("a", "b"), ("b", "a")])
def test_a_service_that_is_called_by_what_it_calls_is_not_cured_by_a_group_of_its_own(
    first: str, last: str, kind: Group
) -> None:
    """``a`` and ``b`` call each other, all in groups of their own; the first one is called from outside."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        clients = {name: node.create_client(SetBool, name, callback_group=kind()) for name in "ab"}

        def a(_: object, response: object) -> object:
            simulation.sleep(0.01)
            clients["b"].call(SetBool.Request())
            return response

        def b(_: object, response: object) -> object:
            simulation.sleep(0.01)
            clients["a"].call(SetBool.Request())
            return response

        node.create_service(SetBool, "a", a, callback_group=kind())
        node.create_service(SetBool, "b", b, callback_group=kind())
        once(node, 1.0, lambda: clients[first].call(SetBool.Request()), kind())
        spin(node, 8)

    run = diagnosed(program)
    (told,) = (each.explained(run.timeline) for each in run.findings)
    assert " is called from within itself, by way of " in told.why
    is_kept_out = kind is MutuallyExclusiveCallbackGroup
    if is_kept_out:
        assert told.why.startswith(f"/{first} is called from within itself, by way of {last}, ")
        assert told.cure.startswith(f"let {last} call {first} as a function; or, ")
    assert (f"give {first} and {last} a ReentrantCallbackGroup each" in told.cure) == is_kept_out
    assert not told.remedies


def test_a_service_in_the_callers_group_is_a_deadlock() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_service(SetBool, "own", lambda _, response: response)
        client = node.create_client(SetBool, "own", callback_group=MutuallyExclusiveCallbackGroup())

        def caller() -> None:
            client.call(SetBool.Request())

        once(node, 1.0, caller)
        spin(node, 4)

    run = diagnosed(program)
    assert run.problems() == {("self-made-deadlock", "caller")}
    assert "/own waits for group" in run.explained("self-made-deadlock").what


def test_awaiting_a_reply_in_ones_own_exclusive_group_is_a_deadlock() -> None:
    def awaiting(group: CallbackGroup | None) -> Diagnosed:
        def program(simulation: Simulation) -> None:
            serve_outside(simulation)
            node = Node("n")
            client = node.create_client(SetBool, "/outside", callback_group=group)

            async def caller() -> None:
                await client.call_async(SetBool.Request())

            once(node, 1.0, caller)
            spin(node, None)

        return diagnosed(program)

    assert awaiting(None).problems() == {("self-made-deadlock", "caller")}
    assert awaiting(MutuallyExclusiveCallbackGroup()).problems() == set()


def test_a_service_that_awaits_in_vain_stays_a_deadlock_when_its_queue_loses_requests() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        outside = node.create_client(SetBool, "/outside")
        asking = node.create_client(SetBool, "/own", callback_group=MutuallyExclusiveCallbackGroup())

        async def serve(_request: Any, response: Any) -> Any:
            await outside.call_async(SetBool.Request())
            return response

        node.create_service(SetBool, "/own", serve)
        for tenth in range(1, 30):
            simulation.at(0.1 * tenth, lambda: asking.call_async(SetBool.Request()))
        spin(node, None)

    assert diagnosed(program).problems() == {("self-made-deadlock", "serve")}


def test_a_callback_that_awaits_in_vain_is_told_at_its_await() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")

        async def answer() -> None:
            future = client.call_async(SetBool.Request())
            await future

        async def caller() -> None:
            await answer()

        once(node, 1.0, caller)
        spin(node, None)

    told = diagnosed(program).explained("self-made-deadlock")
    assert told.place is not None
    assert linecache.getline(told.place.file, told.place.first_line).strip() == "await future"
    assert told.cure == (
        "return from caller and go on in future.add_done_callback(), "
        "or give caller a callback group of its own"
    )


def test_a_call_from_a_thread_that_is_no_executors_is_well() -> None:
    def program(simulation: Simulation) -> None:
        serve_outside(simulation, seconds=2.0)
        node = Node("n")
        client = node.create_client(SetBool, "/outside")
        simulation.start(lambda: spin(node, None))
        client.call(SetBool.Request())

    assert diagnosed(program).problems() == set()


SLEEPER = """
import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter

rclpy.init()
node = Node("sleeper", parameter_overrides=[Parameter("use_sim_time", value=True)])
clock = CLOCK
once = node.create_timer(0.5, lambda: clock.sleep_for(Duration(seconds=2.0)), clock=Clock())
rclpy.spin(node)
"""


WORLD = """from rosgraph_msgs.msg import Clock as Message
class World(Node):
    def __init__(self):
        super().__init__('world')
        self.pub = self.create_publisher(Message, '/clock', 10)
        self.create_timer(0.05, self.tell)
    def tell(self):
        self.pub.publish(Message(clock=self.get_clock().now().to_msg()))
import threading
from rclpy.executors import SingleThreadedExecutor
executor = SingleThreadedExecutor()
executor.add_node(World())
"""


def test_a_sleep_on_simulated_time_that_keeps_its_publisher_out_is_a_deadlock(tmp_path: Path) -> None:
    spin = f"{WORLD.replace('0.05', '0.03')}executor.add_node(node)\nexecutor.spin()"
    program = SLEEPER.replace("CLOCK", "node.get_clock()").replace("rclpy.spin(node)", spin)
    run = run_program(tmp_path, program, 3.0)
    (found,) = (each for each in diagnose(run.timeline) if each.rule.id == "self-made-deadlock")
    told = found.explained(run.timeline)
    assert "for ever; tell, which publishes on /clock, needs the only thread, which" in told.what
    assert "a callback group of its own, and spin with MultiThreadedExecutor(num_threads=2)" in told.cure


@pytest.mark.parametrize(
    ("clock", "rules"),
    [("node.get_clock()", ["deadlock-over-the-clock"]), ("Clock(clock_type=ClockType.STEADY_TIME)", [])],
)
def test_a_sleep_on_simulated_time_that_keeps_the_clock_out_is_a_deadlock(
    clock: str, rules: list[str], tmp_path: Path
) -> None:
    world = f"{WORLD}threading.Thread(target=executor.spin, daemon=True).start()\n"
    program = SLEEPER.replace("CLOCK", clock).replace("rclpy.spin(node)", f"{world}rclpy.spin(node)")
    run = run_program(tmp_path, program, 2.0)
    found = [each for each in diagnose(run.timeline) if each.rule.id == "self-made-deadlock"]
    assert [each.rule.kind(each, run.timeline) for each in found] == rules
    for each in found:
        told = each.explained(run.timeline)
        assert "waits for the simulated time for ever; /clock waits for group A" in told.what
        assert "a callback group of its own" in told.cure

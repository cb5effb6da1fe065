"""Exceptions of callbacks that nobody hears of."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

import sim.ros.rclpy as rclpy
from sim.diagnosis import Explanation, diagnose
from sim.quantities.nanoseconds import SECOND
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.trace.events import ExceptionSurfaced, RunEnded
from sim.trace.timeline import Timeline
from tests.diagnosis.findings import Diagnosed, Int32, diagnosed, executor_of, once
from tests.support.engine_runs import run_program
from tests.support.simulation import Simulation, Trace


def raising(threads: int | None, *, ticks_on: bool) -> Diagnosed:
    """``fails`` raises at 1 s; ``tick``, if it is there, is called each second; ``spin`` is called again.

    All workers have run something before: what is raised on one that was just started comes out at once.
    """

    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()

        def fails() -> None:
            raise ValueError("no scan")

        for worker in range(threads or 0):
            once(node, 0.1 * (1 + worker), lambda: None, group)
        once(node, 1.0, fails, group)
        if ticks_on:
            node.create_timer(1.0, lambda: None, group)
        executor = executor_of(threads)
        executor.add_node(node)
        while rclpy.ok():
            with suppress(ValueError):
                executor.spin()

    return diagnosed(program)


def test_an_exception_that_no_later_callback_brings_out_is_swallowed() -> None:
    run = raising(2, ticks_on=False)
    assert run.problems() == {("exception-swallowed", "fails")}
    told = run.explained("exception-swallowed")
    assert told.what == "fails raised what spin() has not raised: ValueError: no scan"
    assert told.place is not None
    assert 'raise ValueError("no scan")' in Path(__file__).read_text().splitlines()[told.place.first_line - 1]


def test_a_callback_that_began_in_the_moment_of_an_exception_does_not_bring_it_out() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()

        def fails() -> None:
            raise ValueError("no scan")

        once(node, 0.5, lambda: None, group)
        once(node, 1.0, lambda: None, group)
        once(node, 1.0, fails, group)
        executor = executor_of(2)
        executor.add_node(node)
        executor.spin()

    assert diagnosed(program).problems() == {("exception-swallowed", "fails")}


def test_an_exception_that_comes_when_the_program_ends_is_told_with_what_main_should_wait_for() -> None:
    events = [each for each in raising(2, ticks_on=False).trace.events if not isinstance(each, RunEnded)]
    ended = RunEnded(max(each.t for each in events), "the program returned", failed=False)
    told = Diagnosed(Trace([*events, ended])).explained("exception-swallowed")
    assert told.why.endswith("spin() had returned or was about to")
    assert told.cure.startswith("catch exceptions in fails and log them; let main() wait for fails")


@pytest.mark.parametrize("threads", [None, 2])
def test_an_exception_that_comes_out_and_is_caught_is_worth_a_remark_at_its_line(threads: int | None) -> None:
    run = raising(threads, ticks_on=True)
    assert run.problems() == set()
    told = run.explained("exception-caught")
    assert told.what == "fails raised ValueError: no scan, and the program caught it"
    assert told.place is not None
    assert Path(__file__).read_text().splitlines()[told.place.first_line - 1].strip().startswith("raise")


def test_what_comes_out_of_a_pool_and_ends_the_program_well_is_not_swallowed() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def fails() -> None:
            raise ValueError("no device")

        once(node, 0.5, fails, ReentrantCallbackGroup())
        executor = executor_of(2)
        executor.add_node(node)
        with suppress(ValueError):
            executor.spin()

    run = diagnosed(program)
    events = [each for each in run.trace.events if not isinstance(each, RunEnded)]
    ended = RunEnded(max(each.t for each in events), "the program returned", failed=False)
    caught = Diagnosed(Trace([*events, ended]))
    assert caught.problems() == set()
    assert (
        caught.explained("exception-caught").what
        == "fails raised ValueError: no device, and the program caught it"
    )
    [surfaced] = [each for each in events if isinstance(each, ExceptionSurfaced)]
    kept = [each for each in events if each is not surfaced]
    of_another_line = replace(surfaced, line=surfaced.line + 1)
    for others in ([], [of_another_line]):
        assert Diagnosed(Trace([*kept, *others, ended])).problems() == {("exception-swallowed", "fails")}


CAUGHT = "try:\n    rclpy.spin(node)\nexcept BaseException:\n    pass\n"
IN_A_THREAD = "thread = threading.Thread(target=rclpy.spin, args=(node,))\nthread.start()\nthread.join()\n"


@pytest.mark.parametrize(
    ("raised", "spin", "told"),
    [
        ("IndexError('no beam')", CAUGHT, True),
        ("SystemExit", CAUGHT, False),
        ("KeyError", IN_A_THREAD, False),
    ],
)
def test_what_main_catches_and_ends_with_is_worth_a_remark_unless_it_is_raised_to_end(
    raised: str, spin: str, told: bool, tmp_path: Path
) -> None:
    text = (
        "import threading\nimport rclpy\n\nrclpy.init()\nnode = rclpy.create_node('n')\n\n\ndef fails():\n"
        f"    raise {raised}\n\n\nnode.create_timer(0.5, fails)\n{spin}"
    )
    timeline = run_program(tmp_path, text, 2.0).timeline
    assert ("exception-caught" in [each.rule.id for each in diagnose(timeline)]) is told


def test_a_single_threaded_executor_swallows_nothing() -> None:
    assert raising(None, ticks_on=False).problems() == set()


def test_an_exception_that_ended_the_run_is_well_and_one_beside_it_is_lost() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        group = ReentrantCallbackGroup()

        def first() -> None:
            simulation.sleep(0.5)
            raise ValueError("first")

        def second() -> None:
            simulation.sleep(0.6)
            raise ValueError("second")

        once(node, 1.0, first, group)
        once(node, 1.0, second, group)
        once(node, 2.0, lambda: None, group)
        executor = executor_of(3)
        executor.add_node(node)
        with suppress(ValueError):
            executor.spin()

    trace = diagnosed(program).trace
    events = [each for each in trace.events if not isinstance(each, RunEnded)]
    end = max(each.t for each in events)
    sentence = "node.py:3: the program raised ValueError: first"
    ended = RunEnded(end, sentence, failed=True, error="ValueError: first")
    run = Diagnosed(Trace([*events, ended]))
    assert run.problems() == {("exception-swallowed", "second")}


def test_a_timeline_without_errors_is_asked_nothing() -> None:
    assert Diagnosed(Trace([])).findings == ()
    assert Timeline().end == 0


def test_an_exception_is_told_at_its_own_time_though_the_run_went_on_with_others() -> None:
    events = [each for each in raising(None, ticks_on=False).trace.events if not isinstance(each, RunEnded)]
    error = "ValueError: no scan"
    ended = RunEnded(60 * SECOND, error, failed=True, error=error, exception="ValueError", problem=error)
    run = Diagnosed(Trace([*events, ended]))
    found = run.one("program-raised")
    assert (found.at, run.problems()) == (1 * SECOND, {("program-raised", "fails")})


def explained_end(add_to: Callable[[Node], None], threads: int | None = None) -> Explanation:
    """Spin a node with something added to it until an exception ends that, and explain the exception."""
    return ended_by(add_to, threads).explained("program-raised")


def ended_by(add_to: Callable[[Node], None], threads: int | None = None) -> Diagnosed:
    """Spin a node with something added to it until an exception ends that."""
    raised: list[BaseException] = []

    def program(_: Simulation) -> None:
        node = Node("n")
        add_to(node)
        executor = executor_of(threads)
        executor.add_node(node)
        with pytest.raises(Exception) as found:  # noqa: PT011 -- whatever it is, it is explained
            executor.spin()
        raised.append(found.value)

    events = [each for each in diagnosed(program).trace.events if not isinstance(each, RunEnded)]
    kind = type(raised[0]).__name__
    error = f"{kind}: {raised[0]}"
    last = max(each.t for each in events)
    ended = RunEnded(last, error, failed=True, error=error, exception=kind, problem=error)
    return Diagnosed(Trace([*events, ended]))


@pytest.mark.parametrize("threads", [None, 2])
def test_what_asyncio_misses_in_a_callback_is_told_with_what_to_await_instead(threads: int | None) -> None:
    async def tick() -> None:
        await asyncio.sleep(0.1)

    told = explained_end(lambda node: once(node, 1.0, tick, ReentrantCallbackGroup()), threads)
    assert told.why == "an executor of rclpy resumes coroutines itself, and runs no event loop of asyncio"
    assert told.cure.startswith("await only futures of rclpy")


FUTURE_OF_ASYNCIO = """
import asyncio
import rclpy
rclpy.init()
node = rclpy.create_node("n")
done = asyncio.new_event_loop().create_future()

async def tick():
    await done

node.create_timer(0.5, tick)
rclpy.spin(node)
"""


@pytest.mark.parametrize("distro", ["jazzy", "jazzy@7.1.6"])
def test_an_await_of_a_future_of_asyncio_is_told_at_its_line_with_what_to_await_instead(
    distro: str, tmp_path: Path
) -> None:
    timeline = run_program(tmp_path, FUTURE_OF_ASYNCIO, 2.0, distro=distro).timeline
    (told,) = (each.explained(timeline) for each in diagnose(timeline))
    assert told.place is not None
    assert told.place.first_line == 9
    assert told.cure.startswith("await only futures of rclpy")


@pytest.mark.parametrize(
    ("error", "why", "cure"),
    [
        (
            "AttributeError: property 'timers' of 'MyNode' object has no setter",
            "every node of rclpy has a property timers, and nothing can be assigned to it",
            "give the attribute another name, such as my_timers",
        ),
        (
            "AttributeError: can't set attribute 'timers'",
            "every node of rclpy has a property timers, and nothing can be assigned to it",
            "give the attribute another name, such as my_timers",
        ),
        (
            "AttributeError: handle cannot be modified after node creation",
            "every node of rclpy has a property handle, and nothing can be assigned to it",
            "give the attribute another name, such as my_handle",
        ),
        (
            "ValueError: generator already executing",
            "another thread is in the same generator; where this line spins, it spins the same executor",
            "spin an executor in one thread only, and let the others wait for that one to end",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'successful'",
            "the callback of add_on_set_parameters_callback() returned nothing; rclpy needs its answer",
            "end that callback with: return SetParametersResult(successful=True)",
        ),
        (
            "RuntimeError: There is no current event loop in thread 'ThreadPoolExecutor-0_0'.",
            "an executor of rclpy resumes coroutines itself, and runs no event loop of asyncio",
            "await only futures of rclpy, such as that of call_async(), and several one after another; in "
            "place of asyncio.sleep(), await a rclpy.task.Future that a timer completes",
        ),
        (
            "RuntimeError: There is no current event loop in thread 'MainThread'.",
            "an exception that no except clause takes ends the program",
            "correct the line",
        ),
        (
            "AttributeError: property 'speed' of 'Motor' object has no setter",
            "an exception that no except clause takes ends the program",
            "correct the line",
        ),
        (
            "AttributeError: 'NoneType' object has no attribute 'put'",
            "what stands before .put in this line is None: not set yet, or what a function returned",
            "give it a value before this line runs, or ask first whether it is None",
        ),
        (
            "InvalidParameterTypeException: Trying to set parameter 'rate' to '10' of type 'INTEGER', "
            "expecting type 'DOUBLE': rate",
            "the node declares rate with a value of another type, and no type turns into another by itself",
            "write rate:=10.0 in place of rate:=10 where the value comes from: the command line, the launch "
            "file or the file of parameters",
        ),
        (
            "InvalidParameterTypeException: Trying to set parameter 'name' to '10' of type 'INTEGER', "
            "expecting type 'STRING': name",
            "the node declares name with a value of another type, and no type turns into another by itself",
            "give name a value of type STRING where the value comes from: the command line, the launch file "
            "or the file of parameters",
        ),
        (
            "InvalidHandle: cannot use Destroyable because destruction was requested",
            "what this line uses was destroyed before, itself or with its node",
            "destroy it only when nothing uses it any more, or make it again before this line",
        ),
        (
            "RCLError: Failed to create subscription: invalid allocator, at /src/rcl/subscription.c:261",
            "within one process a topic or service has one type: most likely something else of the program "
            "uses the name of this subscription with another type",
            "give all ends of that name the same type, or this subscription another name",
        ),
        (
            "RuntimeError: dictionary changed size during iteration",
            "the dictionary was changed while this line went through it, by this loop or by another thread",
            "go through a copy, such as list(...) of it; and where another thread changes it, hold one lock "
            "around both places",
        ),
    ],
)
def test_an_exception_that_rclpy_makes_of_a_usual_slip_is_told_in_its_terms(
    error: str, why: str, cure: str
) -> None:
    timeline = Timeline()
    timeline.extend([RunEnded(1, error, failed=True, error=error, problem=f"the program raised {error}")])
    (found,) = diagnose(timeline)
    told = found.explained(timeline)
    assert (told.why, told.cure) == (why, cure)


GIVE_DEPTH = "give it as the last argument, such as 10"


@pytest.mark.parametrize(
    ("slip", "cure"),
    [
        (lambda node: type(node)(), "give it one: super().__init__('my_node')"),
        (lambda node: node.create_publisher(Int32, "t"), "give it as the last argument, such as 10"),
        (
            lambda node: node.create_subscription(Int32, "t", print),
            "give it as the last argument, such as 10",
        ),
        (
            lambda node: node.create_subscription(Int32, "t", print, 10, ReentrantCallbackGroup()),
            "name the argument: callback_group=...",
        ),
        (
            lambda node: node.create_timer(node.get_name, 0.5),
            "if this makes a timer, swap the two: create_timer(0.5, self.tick)",
        ),
        (
            lambda node: node.create_publisher(Int32, "t", 10).publish(3),
            "make a Int32(), set its fields, and publish that",
        ),
    ],
)
def test_a_slip_in_a_call_of_rclpy_is_told_with_what_the_call_wants(
    slip: Callable[[Any], object], cure: str
) -> None:
    assert explained_end(lambda node: once(node, 1.0, lambda: slip(node))).cure == cure


def test_a_timer_that_was_given_what_a_call_returned_is_told_with_its_own_line() -> None:
    def add_to(node: Node) -> None:
        nothing: Any = None
        node.create_timer(1.0, nothing)

    told = explained_end(add_to)
    assert told.why == "this timer was made with what a call returned, in place of a function"
    assert told.place is not None
    line = Path(__file__).read_text().splitlines()[told.place.first_line - 1]
    assert "node.create_timer(1.0, nothing)" in line


def spun_by_another_thread(threads: int | None, *, catches: bool = False) -> Diagnosed:
    """``fails`` raises at 2 s on a thread that spins, ``idles`` and ``takes`` wait from then on."""

    def program(simulation: Simulation) -> None:
        node, talker = Node("n"), Node("talker")
        group = ReentrantCallbackGroup()

        def fails() -> None:
            with suppress(*[ValueError] * catches):
                raise ValueError("no scan")

        def idles() -> None: ...

        def takes(_: object) -> None: ...

        node.create_timer(1.0, idles, group)
        node.create_subscription(Int32, "numbers", takes, 2, callback_group=group)
        once(node, 2.0, fails, group)
        publisher = talker.create_publisher(Int32, "numbers", 2)
        talker.create_timer(0.3, lambda: publisher.publish(Int32()))
        executor = executor_of(threads)
        executor.add_node(node)

        def spins() -> None:
            with suppress(ValueError):
                executor.spin()

        simulation.start(spins, "spinner")
        rclpy.spin(talker)

    return diagnosed(program)


@pytest.mark.parametrize("threads", [None, 2])
def test_an_exception_that_ends_the_thread_that_spins_is_the_one_problem(threads: int | None) -> None:
    run = spun_by_another_thread(threads)
    assert run.problems() == {("spin-raised", "fails")}
    told = run.explained("spin-raised")
    on = " on spinner" if threads is None else ""
    assert told.what.startswith(f"fails raised ValueError: no scan{on}, and nobody spins its node any more: ")
    assert "idles" in told.what
    assert "takes" in told.what
    assert told.place is not None
    line = Path(__file__).read_text().splitlines()[told.place.first_line - 1]
    assert line.strip() == 'raise ValueError("no scan")'


def test_what_is_lost_after_an_exception_ended_the_spin_is_part_of_that() -> None:
    run = spun_by_another_thread(None)
    assert run.one("dropped-messages").due_to == run.trace.entity("fails")


def test_a_thread_whose_callbacks_catch_their_exceptions_spins_on() -> None:
    assert spun_by_another_thread(None, catches=True).told() == set()


@pytest.mark.parametrize(("threads", "kind"), [(None, "program-failed"), (2, "program-raised")])
def test_only_an_exception_on_a_worker_is_of_the_kind_that_may_get_lost(
    threads: int | None, kind: str
) -> None:
    def fails() -> None:
        raise ValueError("no scan")

    def add_to(node: Node) -> None:
        once(node, 1.0, fails)
        once(node, 2.0, lambda: None)

    run = ended_by(add_to, threads)
    found = run.one("program-raised")
    assert found.rule.kind(found, run.timeline) == kind


RAISES_IN_A_THREAD = """\
import threading
import time
import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("n")
node.create_timer(0.5, lambda: None)

def work():
    while {condition}:
        time.sleep(0.1)
    raise RuntimeError("late")

threading.Thread(target=work).start()
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("condition", "told"), [("rclpy.ok()", []), ("time.sleep(0.5)", ["thread-raised"])], ids=["end", "before"]
)
def test_what_a_thread_raises_as_the_program_ends_took_nothing_from_the_run(
    condition: str, told: list[str], tmp_path: Path
) -> None:
    run = run_program(tmp_path, RAISES_IN_A_THREAD.format(condition=condition), 2.0)
    assert [each.rule.id for each in diagnose(run.timeline)] == told


def test_a_thread_that_raises_does_so_before_virtual_time_goes_on_to_the_end(tmp_path: Path) -> None:
    program = """
import threading
import time
import rclpy
from rclpy.node import Node

def work():
    time.sleep(0.5)
    raise ValueError("no scan")

rclpy.init()
threading.Thread(target=work).start()
rclpy.spin(Node("n"))
"""
    found = diagnose(run_program(tmp_path, program, 3.0).timeline)
    assert [(each.rule.id, each.at) for each in found] == [("thread-raised", SECOND // 2)]


@pytest.mark.parametrize(
    ("asks", "told"),
    [
        ("work()", "a job that was given to a pool"),
        ("wait([work()])", "a job that was given to a pool"),
        ("asyncio.run_coroutine_threadsafe(fail_later(), loop)", "a coroutine that was given to a loop"),
        ("work().exception()", ""),
        ("work().add_done_callback(lambda future: future.exception())", ""),
        ("kept.append(work())", ""),
        ("kept.append(inspect.getmembers(Future))", ""),
        ("set_by_hand(Future())", ""),
    ],
)
def test_what_a_job_of_a_pool_raises_is_told_if_nobody_can_ask_for_it_any_more(
    asks: str, told: str, tmp_path: Path
) -> None:
    program = f"""
import asyncio
import inspect
import threading
import rclpy
from concurrent.futures import Future, ThreadPoolExecutor, wait
from rclpy.node import Node

rclpy.init()
node, pool, kept, loop = Node("n"), ThreadPoolExecutor(1), [], asyncio.new_event_loop()
threading.Thread(target=loop.run_forever, daemon=True).start()

def fail():
    raise RuntimeError("late")

async def fail_later():
    await asyncio.sleep(0.1)
    fail()

def set_by_hand(future):
    try:
        fail()
    except RuntimeError as error:
        future.set_exception(error)

def work():
    return pool.submit(fail)

def tick():
    {asks}

node.create_timer(0.5, tick)
rclpy.spin(node)
"""
    run = run_program(tmp_path, program, 2.0)
    found = diagnose(run.timeline)
    assert [each.rule.id for each in found] == ["thread-raised"] * bool(told)
    assert all(each.explained(run.timeline).what.startswith(told) for each in found)

"""EventsExecutor: one queue in order of arrival, no group asked; each rule as rclpy's C++ code has it."""

import gc
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.clock.schedule import Schedule
from sim.clock.strategies import RandomWalk
from sim.interfaces import action, message, service
from sim.ros.actions import ActionClient, ActionServer, GoalResponse
from sim.ros.entities.event_handler import SubscriptionEventCallbacks
from sim.ros.internals import compiled as _rclpy
from sim.ros.node.node import Node
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import QoSProfile
from sim.ros.rclpy.experimental import EventsExecutor
from sim.ros.rclpy.experimental.events_executor import EventsExecutor as TheSame
from sim.ros.scheduling.callback_groups import CallbackGroup
from sim.ros.scheduling.task import Future
from sim.ros.scheduling.waiting_ends import ExternalShutdownException
from sim.ros.time.duration import Duration
from sim.trace.events import CallbackResumed, CallbackSuspended, EntityGone, Reason, WaitStarted
from tests.ros.scheduling.waitables import QOS, Waiting
from tests.support.simulation import Simulation, Trace, simulate

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")
Clock = message("rosgraph_msgs", "Clock")
Fibonacci = action("example_interfaces", "Fibonacci")


class Bench:
    """A node on an EventsExecutor, and what its callbacks said."""

    def __init__(self, simulation: Simulation) -> None:
        self.simulation = simulation
        self.said: list[Any] = []
        self.node = Node("n")
        self.executor = EventsExecutor()
        self.executor.add_node(self.node)

    def hear(self, topic: str, lasts: float = 0.0, depth: int = 10) -> Any:
        """A subscription that says the numbers it gets; returns its publisher."""

        def heard(number: Any) -> None:
            self.said.append(f"{topic}{number.data}")
            self.simulation.sleep(lasts)

        self.node.create_subscription(Int32, topic, heard, depth)
        return self.node.create_publisher(Int32, topic, 10)

    def register(self) -> None:
        """Have the executor hear of all that was made so far."""
        self.executor.spin_once(timeout_sec=0)

    def spin_once(self) -> list[Any]:
        """Spin once without waiting; what was said meanwhile."""
        before = len(self.said)
        self.executor.spin_once(timeout_sec=0)
        return self.said[before:]

    def spin_for(self, seconds: float) -> None:
        """Spin for so long at least."""
        self.executor.spin_until_future_complete(Future(), seconds)


def on_bench(
    program: Callable[[Bench], None],
    until: float = 10.0,
    distro: str = "jazzy",
    schedule: Schedule | None = None,
) -> tuple[list[Any], Trace]:
    """Run a program with a bench on virtual time: what was said, and the trace."""
    benches: list[Bench] = []

    def run(simulation: Simulation) -> None:
        benches.append(Bench(simulation))
        program(benches[0])

    trace = simulate(run, until, schedule, distro)
    return benches[0].said, trace


def _deadline(bench: Bench) -> Callable[[], Any]:
    """A subscription whose deadline passes."""
    callbacks = SubscriptionEventCallbacks(deadline=bench.said.append)
    qos = QoSProfile(depth=1, deadline=Duration(seconds=1))
    bench.node.create_subscription(Int32, "d", lambda _: None, qos, event_callbacks=callbacks)
    bench.node.create_publisher(Int32, "d", qos).publish(Int32())
    return lambda: bench.said[0].total_count == 1


def _waitable(bench: Bench) -> Callable[[], Any]:
    """A waitable of the program's own, for a message."""
    with bench.node.handle:
        subscription = _rclpy.Subscription(bench.node.handle, Int32, "w", QOS)
    waiting = Waiting("subscription", subscription, lambda each: each.take_message(Int32, False)[0])
    bench.node.add_waitable(waiting)
    publisher = bench.node.create_publisher(Int32, "w", 1)
    bench.simulation.at(1.0, lambda: publisher.publish(Int32(data=3)))
    return lambda: waiting.future.result() == Int32(data=3)


def _goal(bench: Bench) -> Callable[[], Any]:
    """An action server, and a goal that is sent to it."""

    def execute(goal: Any) -> Any:
        goal.succeed()
        return Fibonacci.Result(sequence=[1])

    ActionServer(bench.node, Fibonacci, "f", execute)
    client = ActionClient(bench.node, Fibonacci, "f")
    results: list[Any] = []

    async def send() -> None:
        timer.cancel()
        goal: Any = await client.send_goal_async(Fibonacci.Goal())
        results.append((await goal.get_result_async()).result)

    timer = bench.node.create_timer(0.5, send)
    return lambda: results == [Fibonacci.Result(sequence=[1])]


def numbers(count: int) -> list[Any]:
    """Messages that count up from 0."""
    return [Int32(data=each) for each in range(count)]


def test_both_modules_that_programs_import_it_from_have_it() -> None:
    assert TheSame is EventsExecutor


def test_messages_come_in_the_order_of_their_arrival_not_of_their_subscriptions() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a"), bench.hear("b")
        bench.register()
        for each in numbers(2):
            b.publish(each)
            a.publish(each)
        bench.spin_for(1)

    assert on_bench(program)[0] == ["b0", "a0", "b1", "a1"]


def test_what_waits_when_a_node_is_added_is_one_event_a_subscription() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a"), bench.hear("b")
        for each in numbers(2):
            b.publish(each)
            a.publish(each)
        bench.said.append(bench.spin_once())
        bench.said.append(bench.spin_once())

    assert on_bench(program)[0][2::3] == [["a0", "a1"], ["b0", "b1"]]


def test_a_newer_message_takes_the_place_of_the_dropped_one_and_leaves_its_own_empty() -> None:
    def program(bench: Bench) -> None:
        a, b = bench.hear("a", depth=1), bench.hear("b")
        bench.register()
        a.publish(Int32(data=0))
        b.publish(Int32(data=0))
        a.publish(Int32(data=1))
        bench.said.append([bench.spin_once() for _ in range(3)])

    assert on_bench(program)[0][-1] == [["a1"], ["b0"], []]


def test_no_group_is_asked() -> None:
    class Asked(CallbackGroup):
        def can_execute(self, entity: object) -> bool:
            return False

        beginning_execution = can_execute

        def ending_execution(self, entity: object) -> None:
            raise AssertionError

    def program(bench: Bench) -> None:
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"), callback_group=Asked())
        bench.spin_for(1.5)

    assert on_bench(program)[0] == ["tick"]


def test_a_suspended_callback_keeps_nobody_out_of_its_group() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_service(SetBool, "s", lambda _, response: response)
        client = bench.node.create_client(SetBool, "s")

        async def ask() -> None:
            timer.cancel()
            bench.said.append("asks")
            bench.said.append(await client.call_async(SetBool.Request()))

        timer = bench.node.create_timer(1.0, ask)
        bench.spin_for(1.5)

    said, trace = on_bench(program)
    assert said == ["asks", SetBool.Response()]
    assert len(trace.of(CallbackSuspended)) == 2  # it begins as a task, and then awaits the reply
    assert len(trace.of(CallbackResumed)) == 2


def test_a_due_timer_is_called_behind_what_came_before_it_was_looked_at() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=0.4)
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"))
        bench.register()
        bench.simulation.at(0.9, lambda: a.publish(Int32(data=0)))
        bench.simulation.at(0.95, lambda: a.publish(Int32(data=1)))
        bench.simulation.at(1.2, lambda: a.publish(Int32(data=2)))
        bench.spin_for(2.0)

    # Its look is queued at 1.0, behind a1 and before a2; its call is queued at that look, behind a2.
    assert on_bench(program)[0][:4] == ["a0", "a1", "a2", "tick"]


def test_a_timer_that_waits_for_its_turn_is_called_again_for_each_reset_of_another_one() -> None:
    def program(bench: Bench) -> None:
        node = bench.node
        other = node.create_timer(50.0, lambda: None)
        ticking = node.create_timer(0.5, lambda: bench.said.append(ticking.time_until_next_call()))

        def slow() -> None:
            once.cancel()
            bench.simulation.sleep(0.3)
            other.reset()
            other.reset()

        once = node.create_timer(0.3, slow)
        bench.spin_for(1.9)

    # Measured on Jazzy 7.1.5: 0.40, 0.90 and 1.40 at once, then nothing until 2.0.
    assert on_bench(program)[0] == [400_000_000, 900_000_000, 1_400_000_000]


@pytest.mark.parametrize(
    ("resets", "called"), [(0, ["a", "a", "b", "b"]), (1, ["a", "a", "a", "b", "b"])], ids=["made", "reset"]
)
def test_a_timer_that_is_reset_before_it_is_served_has_timers_looked_at_once_more(
    resets: int, called: list[str]
) -> None:
    def program(bench: Bench) -> None:
        node = bench.node

        def slow() -> None:
            once.cancel()
            made = node.create_timer(50.0, lambda: None)
            for _ in range(resets):
                made.reset()
            bench.simulation.sleep(0.5)

        def tick() -> None:
            bench.said.append("a")
            bench.simulation.sleep(0.0 if bench.said[1:] else 0.5)

        once = node.create_timer(0.1, slow)
        node.create_timer(0.3, tick)
        node.create_timer(0.95, lambda: bench.said.append("b"))
        bench.spin_for(1.15)

    # Measured on Jazzy 7.1.5 and Kilted 9.1.2, a and b in either order at 1.1 s.
    assert sorted(on_bench(program)[0]) == called


def test_ticks_that_were_missed_are_dropped() -> None:
    def program(bench: Bench) -> None:
        def slow() -> None:
            bench.said.append(round(bench.simulation.now, 3))
            if len(bench.said) == 2:
                bench.simulation.sleep(0.35)

        bench.node.create_timer(0.1, slow)
        bench.spin_for(0.75)

    assert on_bench(program)[0] == [0.1, 0.2, 0.55, 0.6, 0.7]


def test_a_timer_that_is_cancelled_while_it_is_queued_is_not_called() -> None:
    def program(bench: Bench) -> None:
        def first() -> None:
            bench.said.append("first")
            second.cancel()

        bench.node.create_timer(1.0, first)
        second = bench.node.create_timer(1.0, lambda: bench.said.append("second"))
        bench.spin_for(1.5)

    assert on_bench(program)[0] == ["first"]


def test_tasks_queue_in_order_among_the_rest() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        bench.executor.create_task(bench.said.append, "first")
        a.publish(Int32(data=0))
        bench.executor.create_task(bench.said.append, "second")
        bench.said.append([bench.spin_once() for _ in range(3)])

    assert on_bench(program)[0][-1] == [["first"], ["a0"], ["second"]]


def test_spin_once_runs_one_callback_and_stops() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        for each in numbers(2):
            a.publish(each)
        bench.said.append(bench.spin_once())

    assert on_bench(program)[0] == ["a0", ["a0"]]


def test_a_negative_timeout_does_not_wait() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_timer(1.0, lambda: bench.said.append("tick"))
        bench.executor.spin_once(timeout_sec=-1)
        bench.said.append(bench.simulation.now)

    assert on_bench(program)[0] == [0.0]


def test_a_timeout_ends_nothing_as_long_as_there_are_events() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=0.2)
        bench.register()
        for each in numbers(5):
            a.publish(each)
        bench.spin_for(0.3)
        bench.said.append(round(bench.simulation.now, 3))

    # Measured on Jazzy 7.1.5: back 1.0 s later, not 0.3.
    assert on_bench(program)[0] == ["a0", "a1", "a2", "a3", "a4", 1.0]


def test_a_done_future_ends_the_spinning_and_leaves_the_rest_in_the_queue() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")
        bench.register()
        future: Future[int] = Future()
        bench.executor.create_task(future.set_result, 1)
        a.publish(Int32(data=0))
        bench.executor.spin_until_future_complete(future)
        bench.said.append("done")
        bench.spin_for(0.1)

    assert on_bench(program)[0] == ["done", "a0"]


def test_a_guard_condition_is_refused_out_of_spin() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_guard_condition(lambda: None)
        with pytest.raises(RuntimeError, match="Guard conditions not supported"):
            bench.executor.spin_once(timeout_sec=1)

    on_bench(program)


def test_it_cannot_be_spun_while_it_spins() -> None:
    def program(bench: Bench) -> None:
        def nested() -> None:
            with pytest.raises(RuntimeError, match="Attempt to spin an already-spinning Executor"):
                bench.executor.spin_once()
            bench.said.append("refused")

        bench.node.create_timer(1.0, nested)
        bench.executor.spin_once()

    assert on_bench(program)[0] == ["refused"]


def test_an_exception_is_logged_and_leaves_spin_and_the_next_spin_comes_back_at_once() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")

        def fail(_: Any) -> None:
            raise ValueError("boo")

        bench.node.create_subscription(Int32, "a", fail, 10)
        bench.register()
        a.publish(Int32(data=0))
        a.publish(Int32(data=1))
        bench.said.append(bench.spin_once())
        with pytest.raises(ValueError, match="boo"):
            bench.spin_once()
        bench.said.append(bench.spin_once())
        bench.said.append(bench.spin_once())

    said, trace = on_bench(program)
    assert said == ["a0", ["a0"], [], "a1", ["a1"]]
    fatal, where = trace.said()
    assert fatal == "Exception in 'subscriptions' callback: boo"
    assert where.startswith("Error occurred at:\n")
    assert "in fail" in where
    assert "scheduling/" not in where.partition("in fail")[0].replace("tests/ros/scheduling", "")


@pytest.mark.parametrize("nodes", [1, 2])
def test_an_exception_of_a_task_leaves_spin_where_rclpy_with_one_node_would_crash(nodes: int) -> None:
    def program(bench: Bench) -> None:
        async def fail() -> None:
            raise ValueError("boo")

        if nodes == 2:
            bench.executor.add_node(Node("other"))
        bench.executor.create_task(fail)
        with pytest.raises(ValueError, match="boo"):
            bench.executor.spin_once()

    said = on_bench(program)[1].said()
    assert said[0] == "Exception in 'task' callback: boo"
    assert any("segmentation fault" in line for line in said) is (nodes == 1)


def test_in_earlier_releases_a_subscriptions_coroutine_is_never_run() -> None:
    def program(bench: Bench) -> None:
        async def heard(_: Any) -> None:
            bench.said.append("never")

        bench.node.create_subscription(Int32, "a", heard, 10)
        bench.register()
        bench.node.create_publisher(Int32, "a", 10).publish(Int32())
        with pytest.warns(RuntimeWarning, match="was never awaited"):
            bench.spin_once()

    assert on_bench(program, distro="jazzy@7.1.10")[0] == []


def spin_in_vain(bench: Bench) -> None:
    with pytest.raises(TypeError):
        bench.spin_once()
    gc.collect()  # the exception's traceback holds the coroutine


def test_in_earlier_releases_a_services_coroutine_is_no_response() -> None:
    def program(bench: Bench) -> None:
        async def serve(_: Any, response: Any) -> Any:
            return response

        bench.node.create_service(SetBool, "s", serve)
        bench.register()
        reply = bench.node.create_client(SetBool, "s").call_async(SetBool.Request())
        with pytest.warns(RuntimeWarning, match="was never awaited"):
            spin_in_vain(bench)
        bench.said.append(reply.done())

    said, trace = on_bench(program, distro="jazzy@7.1.10")
    assert said == [False]
    assert trace.said() == []  # what is raised after the callback is not logged


def test_a_call_inside_a_callback_finds_nobody_to_answer() -> None:
    def program(bench: Bench) -> None:
        def serve(_: Any, response: Any) -> Any:
            bench.said.append("serves")
            return response

        bench.node.create_service(SetBool, "s", serve)
        client = bench.node.create_client(SetBool, "s")

        def ask() -> None:
            timer.cancel()
            bench.said.append(client.call(SetBool.Request(), timeout_sec=0.5))

        timer = bench.node.create_timer(1.0, ask)
        bench.spin_for(2.0)

    assert on_bench(program)[0] == [None, "serves"]


def test_what_is_queued_for_a_destroyed_subscription_is_still_heard() -> None:
    def program(bench: Bench) -> None:
        def heard(number: Any) -> None:
            bench.said.append(number.data)
            if number.data == 0:
                bench.node.destroy_subscription(subscription)

        subscription = bench.node.create_subscription(Int32, "a", heard, 10)
        publisher = bench.node.create_publisher(Int32, "a", 10)
        bench.register()
        for each in numbers(3):
            publisher.publish(each)
        bench.spin_for(1.0)
        publisher.publish(Int32(data=3))
        bench.spin_for(1.0)

    said, trace = on_bench(program)
    assert said == [0, 1, 2]
    assert len(trace.of(EntityGone)) == 1
    assert len(trace.ends("heard")) == 3
    trace.timeline()


def test_what_a_callback_destroys_gets_messages_until_the_queue_is_at_its_update() -> None:
    def program(bench: Bench) -> None:
        def first(number: Any) -> None:
            bench.said.append(("first", number.data))
            if number.data == 1:
                bench.node.destroy_subscription(second)
                bench.node.destroy_service(service)
                publisher.publish(Int32(data=2))
                client.call_async(SetBool.Request())
                bench.said.append((publisher.get_subscription_count(), client.service_is_ready()))

        bench.node.create_subscription(Int32, "a", first, 10)
        second = bench.node.create_subscription(
            Int32, "a", lambda number: bench.said.append(("second", number.data)), 1
        )
        service = bench.node.create_service(SetBool, "s", lambda _, response: bench.said.append("serves"))
        client = bench.node.create_client(SetBool, "s")
        publisher = bench.node.create_publisher(Int32, "a", 10)
        bench.register()
        publisher.publish(Int32(data=1))
        bench.spin_for(1.0)
        bench.said.append((publisher.get_subscription_count(), client.service_is_ready()))

    said, _ = on_bench(program)
    assert said == [("first", 1), (2, True), ("second", 2), ("first", 2), (1, False)]


def test_shutdown_of_the_context_lets_the_queue_run_out_first() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a")

        def end() -> None:
            rclpy.shutdown()
            bench.said.append("ends")

        bench.register()
        bench.executor.create_task(end)
        a.publish(Int32(data=0))
        with pytest.raises(ExternalShutdownException):
            bench.executor.spin()
        bench.said.append(bench.executor.get_nodes())

    assert on_bench(program)[0] == ["ends", "a0", []]


def test_shutdown_from_another_thread_ends_the_spinning_and_lets_the_nodes_go() -> None:
    def program(bench: Bench) -> None:
        def end() -> None:
            bench.simulation.sleep(1.0)
            bench.said.append(bench.executor.shutdown())

        bench.node.create_timer(0.4, lambda: bench.said.append("tick"))
        bench.simulation.start(end)
        bench.executor.spin()
        bench.simulation.sleep(0)
        bench.said.append(bench.executor.get_nodes())

    assert on_bench(program)[0] == ["tick", "tick", True, []]


def test_a_callback_that_shuts_its_executor_down_waits_for_itself() -> None:
    def program(bench: Bench) -> None:
        bench.executor.create_task(lambda: bench.said.append(bench.executor.shutdown(0.5)))
        bench.executor.spin_once()
        bench.said.append(bench.simulation.now)

    assert on_bench(program)[0] == [False, 0.5]


def test_who_waits_does_so_behind_others_in_the_event_queue() -> None:
    def program(bench: Bench) -> None:
        a = bench.hear("a", lasts=1.0)
        bench.node.create_timer(0.5, lambda: None)
        bench.register()
        a.publish(Int32(data=0))
        bench.spin_for(1.2)

    trace = on_bench(program)[1]
    (wait, *_) = trace.of(WaitStarted)
    heard, timer = sorted(trace.names)
    assert (wait.t, wait.entity, wait.reason, wait.holder) == (500_000_000, timer, Reason.EVENT_QUEUE, heard)


@pytest.mark.parametrize("make", [_deadline, _waitable, _goal])
def test_what_rclpy_calls_waitables_is_served_as_a_task(make: Callable[[Bench], Any]) -> None:
    def program(bench: Bench) -> None:
        heard = make(bench)
        bench.spin_for(2.0)
        bench.said.append(heard())

    assert on_bench(program)[0][-1]


def test_an_action_is_a_task_behind_what_its_message_found_queued() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2.
    def program(bench: Bench) -> None:
        def goal(_: Any) -> GoalResponse:
            bench.said.append("goal")
            return GoalResponse.ACCEPT

        def execute(goal: Any) -> Any:
            bench.said.append("execute")
            goal.succeed()
            return Fibonacci.Result()

        def count(number: int) -> None:
            bench.said.append(number)
            if number < 4:
                bench.executor.create_task(count, number + 1)

        def send() -> None:
            timer.cancel()
            accepted = client.send_goal_async(Fibonacci.Goal())
            accepted.add_done_callback(lambda _: bench.said.append("accepted"))
            bench.executor.create_task(count, 0)

        ActionServer(bench.node, Fibonacci, "f", execute, goal_callback=goal)
        client = ActionClient(bench.node, Fibonacci, "f")
        timer = bench.node.create_timer(0.5, send)
        bench.spin_for(1.0)

    assert on_bench(program)[0] == [0, "goal", 1, "execute", 2, 3, "accepted", 4]


def test_timers_that_fell_due_while_something_ran_come_in_any_order() -> None:
    def program(bench: Bench) -> None:
        bench.node.create_timer(0.5, lambda: bench.simulation.sleep(0.4))
        bench.node.create_timer(0.7, lambda: bench.said.append("first"))
        bench.node.create_timer(0.8, lambda: bench.said.append("second"))
        bench.spin_for(0.95)

    assert on_bench(program)[0] == ["first", "second"]
    orders = {tuple(on_bench(program, schedule=RandomWalk(seed))[0]) for seed in range(8)}
    assert orders == {("first", "second"), ("second", "first")}


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted@9.1.2"])
def test_timers_of_two_nodes_that_fell_due_while_something_ran_come_in_order(distro: str) -> None:
    # Measured on both: each node has a clock, and each clock its own wait for the next timer.
    def program(bench: Bench) -> None:
        other = Node("m")
        bench.executor.add_node(other)
        bench.hear("busy", lasts=0.9).publish(Int32())
        bench.node.create_timer(0.5, lambda: bench.said.append("first"))
        other.create_timer(0.7, lambda: bench.said.append("second"))
        bench.spin_for(0.95)

    assert on_bench(program, distro=distro)[0] == ["busy0", "first", "second"]


def test_the_response_of_a_services_coroutine_is_an_event_behind_others() -> None:
    # Measured on Kilted 9.1.2: a done-callback of the task sends it, which is a task itself.
    def program(bench: Bench) -> None:
        async def serve(_: Any, response: Any) -> Any:
            first.publish(Int32())
            return response

        def hear(topic: str, then: Any) -> Any:
            def heard(_: Any) -> None:
                bench.said.append(topic)
                if then is not None:
                    then.publish(Int32())

            bench.node.create_subscription(Int32, topic, heard, 10)
            return bench.node.create_publisher(Int32, topic, 10)

        first = hear("first", hear("second", hear("third", None)))
        bench.node.create_service(SetBool, "s", serve)
        client = bench.node.create_client(SetBool, "s")
        bench.register()
        client.call_async(SetBool.Request()).add_done_callback(lambda _: bench.said.append("got"))
        bench.spin_for(0.5)

    assert on_bench(program, distro="kilted")[0] == ["first", "second", "third", "got"]


def test_the_end_of_a_goal_has_timers_looked_at_once_more() -> None:
    # Measured on Jazzy 7.1.5 and Kilted 9.1.2: the timer by which rcl forgets goals is among them.
    def program(bench: Bench) -> None:
        def execute(goal: Any) -> Any:
            bench.simulation.sleep(0.3)
            goal.succeed()
            return Fibonacci.Result()

        def send() -> None:
            timer.cancel()
            client.send_goal_async(Fibonacci.Goal())

        ActionServer(bench.node, Fibonacci, "f", execute)
        client = ActionClient(bench.node, Fibonacci, "f")
        timer = bench.node.create_timer(0.5, send)
        bench.node.create_timer(0.6, lambda: bench.said.append(round(bench.simulation.now, 3)))
        bench.spin_for(2.0)

    assert on_bench(program)[0] == [0.8, 0.8, 1.8]


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted"])
def test_what_awaits_is_asked_behind_what_the_next_callback_sends(distro: str) -> None:
    # Measured on both.
    def program(bench: Bench) -> None:
        future: Future[None] = Future()

        async def wait() -> None:
            await future
            bench.said.append("goes on")

        def first(_: Any) -> None:
            second.publish(Int32())

        def give(_: Any) -> None:
            future.set_result(None)
            third.publish(Int32(data=3))

        bench.node.create_subscription(Int32, "first", first, 10)
        bench.node.create_subscription(Int32, "second", give, 10)
        third = bench.hear("third")
        second = bench.node.create_publisher(Int32, "second", 10)
        bench.register()
        bench.executor.create_task(wait)
        bench.node.create_publisher(Int32, "first", 10).publish(Int32())
        bench.spin_for(0.5)

    assert on_bench(program, distro=distro)[0] == ["goes on", "third3"]


@pytest.mark.parametrize("distro", ["jazzy@7.1.5", "kilted@9.1.2"])
def test_a_reply_reaches_the_clients_of_its_service_in_the_order_of_their_making(distro: str) -> None:
    # Measured on both: what awaits is asked behind the older client, which takes nothing.
    def program(bench: Bench) -> None:
        bench.node.create_service(SetBool, "s", lambda _, response: response)
        older, newer = (bench.node.create_client(SetBool, "s") for _ in range(2))
        bench.register()

        async def wait() -> None:
            for _ in range(2):
                newer.call_async(SetBool.Request()).add_done_callback(lambda _: bench.said.append("got"))
            await older.call_async(SetBool.Request())
            bench.said.append("goes on")

        bench.executor.create_task(wait)
        bench.spin_for(0.5)

    assert on_bench(program, distro=distro)[0] == ["got", "goes on", "got"]


def test_a_programs_waitable_may_have_no_guard_condition() -> None:
    def program(bench: Bench) -> None:
        with bench.node.context.handle:
            guard = _rclpy.GuardCondition(bench.node.context.handle)
        bench.node.add_waitable(Waiting("guard_condition", guard, lambda _: None))
        with pytest.raises(RuntimeError, match="Guard conditions not supported"):
            bench.executor.spin_once(timeout_sec=1)

    on_bench(program)


def test_a_timer_on_ros_time_is_called_when_that_comes() -> None:
    def program(bench: Bench) -> None:
        bench.node.set_parameters([Parameter("use_sim_time", value=True)])
        bench.node.create_timer(1.0, lambda: bench.said.append(bench.simulation.now))
        clock = bench.node.create_publisher(Clock, "/clock", 10)
        bench.register()
        for second in range(4):
            told = Clock()
            told.clock.sec = 100 + second
            bench.simulation.at(0.1 * (1 + second), partial(clock.publish, told))
        bench.spin_for(1.0)

    assert on_bench(program)[0] == pytest.approx([0.1, 0.2, 0.3, 0.4])


def test_a_node_that_is_not_spun_waits_for_that() -> None:
    def program(bench: Bench) -> None:
        bench.hear("a").publish(Int32(data=0))
        bench.simulation.sleep(1.0)

    (wait,) = on_bench(program)[1].of(WaitStarted)
    assert wait.reason is Reason.NOBODY_SPINS

"""Timers: first one period after creation, never in bursts, and rates that sleep by them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

import sim.ros.rclpy as rclpy
from sim.ros.clocks.ros_time_schedule import next_due
from sim.ros.exceptions import RCLError, ROSInterruptException
from sim.ros.node.node import Node
from sim.ros.scheduling.callback_groups import ReentrantCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.trace.events import TimerCancelled, TimerReset
from tests.support.builder import ns
from tests.support.simulation import Simulation, Trace, simulate


def spin_with_timer(period: float, until: float, blocks: dict[int, float] | None = None) -> Trace:
    """Spin a node whose timer's n-th call takes ``blocks[n]`` seconds."""

    def program(simulation: Simulation) -> None:
        node = Node("n")
        calls = 0

        def tick() -> None:
            nonlocal calls
            calls += 1
            simulation.sleep((blocks or {}).get(calls, 0.0))

        node.create_timer(period, tick)
        rclpy.spin(node)

    return simulate(program, until)


def test_the_first_call_comes_one_period_after_creation() -> None:
    assert spin_with_timer(0.25, until=1.1).times("tick") == [0.25, 0.5, 0.75, 1.0]


def test_ticks_missed_while_blocked_are_dropped_and_the_old_rhythm_goes_on() -> None:
    assert spin_with_timer(0.1, until=0.75, blocks={2: 0.35}).times("tick") == [0.1, 0.2, 0.55, 0.6, 0.7]


def test_a_block_that_ends_on_a_tick_brings_one_call_and_not_two() -> None:
    assert spin_with_timer(0.1, until=0.75, blocks={2: 0.3}).times("tick") == [0.1, 0.2, 0.5, 0.6, 0.7]


def test_a_callback_as_long_as_the_period_is_called_back_to_back() -> None:
    blocks = dict.fromkeys(range(1, 9), 0.1)
    assert spin_with_timer(0.1, until=0.45, blocks=blocks).times("tick") == [0.1, 0.2, 0.3, 0.4]


def test_the_age_of_a_timers_call_is_how_late_it_is() -> None:
    trace = spin_with_timer(0.1, until=0.75, blocks={2: 0.35})
    starts = [each for each in trace.events if type(each).__name__ == "CallbackStarted"]
    assert [each.age for each in starts] == [0, 0, 250_000_000, 0, 0]  # type: ignore[attr-defined]


@given(st.integers(0, 10**6), st.integers(1, 1000), st.integers(0, 10**6))
def test_the_next_due_time_lies_ahead_on_the_old_rhythm_and_skips_nothing_to_come(
    due: int, period: int, late: int
) -> None:
    now = due + late
    following = next_due(due, period, now)
    assert now < following <= now + period
    assert (following - due) % period == 0


def test_a_timer_of_period_zero_is_always_due() -> None:
    assert next_due(5, 0, 5) == 5
    assert next_due(5, 0, 9) == 9


def test_a_timer_of_period_zero_and_a_subscription_share_the_executor() -> None:
    order: list[str] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        guard = node.create_guard_condition(lambda: order.append("guard"))

        def busy() -> None:
            order.append("timer")
            if len(order) == 1:
                guard.trigger()
            if len(order) >= 5:
                rclpy.shutdown()

        node.create_timer(0.0, busy)
        rclpy.spin(node)

    simulate(program)
    assert order == ["timer", "timer", "guard", "timer", "timer"]


def test_a_negative_period_is_an_error() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        with pytest.raises(RCLError, match="timer period must be non-negative"):
            node.create_timer(-0.1, lambda: None)
        timer = node.create_timer(0.1, lambda: None)
        with pytest.raises(ValueError, match="timer period must be non-negative"):
            timer.timer_period_ns = -1

    simulate(program)


def test_a_cancelled_timer_rests_until_it_is_reset() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def tick() -> None:
            timer.cancel()
            assert timer.is_canceled()
            assert timer.time_until_next_call() is None
            assert not timer.is_ready()

        timer = node.create_timer(0.1, tick)
        simulation.at(0.75, timer.reset)
        rclpy.spin(node)

    trace = simulate(program, until=2.0)
    assert trace.times("tick") == [0.1, 0.85]
    assert [event.t for event in trace.of(TimerCancelled)] == [100_000_000, 850_000_000]
    assert [event.t for event in trace.of(TimerReset)] == [750_000_000]
    timeline, tick = trace.timeline(), trace.of(TimerCancelled)[0].entity
    told = [timeline.cancel_since(tick, 0, ns(at)) for at in (0.05, 0.7, 0.8, 1.0)]
    assert [type(each) for each in told] == [type(None), TimerCancelled, TimerReset, TimerCancelled]


def test_a_reset_puts_off_the_next_call_by_a_whole_period() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(0.5, lambda: None)
        simulation.at(0.4, timer.reset)
        rclpy.spin(node)

    assert simulate(program, until=1.5).times("<lambda>") == [0.9, 1.4]


def test_a_timer_that_is_cancelled_while_it_waits_is_not_called() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")

        def block() -> None:
            simulation.sleep(1.0)
            other.cancel()

        blocker = node.create_timer(0.1, block)
        other = node.create_timer(0.2, lambda: None)
        simulation.at(0.5, blocker.cancel)
        rclpy.spin(node)

    assert simulate(program, until=3.0).order() == ["block"]


def test_without_autostart_a_timer_waits_for_its_reset() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(0.5, lambda: None, autostart=False)
        assert timer.is_canceled()
        simulation.at(2.0, timer.reset)
        rclpy.spin(node)

    assert simulate(program, until=3.1).times("<lambda>") == [2.5, 3.0]


def test_a_new_period_keeps_the_pending_due_time() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(1.0, lambda: None)

        def quicken() -> None:
            timer.timer_period_ns = 250_000_000

        simulation.at(0.3, quicken)
        rclpy.spin(node)

    assert simulate(program, until=1.6).times("<lambda>") == [1.0, 1.25, 1.5]


def test_a_timer_tells_how_long_until_and_since_its_call() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(1.0, lambda: None)
        assert (timer.timer_period_ns, timer.is_ready()) == (1_000_000_000, False)
        simulation.sleep(0.25)
        assert timer.time_until_next_call() == 750_000_000
        assert timer.time_since_last_call() == 250_000_000
        simulation.sleep(1.0)
        assert timer.time_until_next_call() == -250_000_000
        assert timer.is_ready()
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        executor.spin_once(timeout_sec=0)
        assert timer.time_since_last_call() == 0
        assert timer.time_until_next_call() == 750_000_000

    assert simulate(program).times("<lambda>") == [1.25]


def test_a_slow_reentrant_timer_overlaps_itself_up_to_the_number_of_threads() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, lambda: simulation.sleep(2.5), ReentrantCallbackGroup())
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    calls = simulate(program, until=7.9).calls()
    assert [each.at for each in calls] == [1.0, 2.0, 3.5, 4.5, 6.0, 7.0]
    assert {each.thread for each in calls} == {"ThreadPoolExecutor-0_0", "ThreadPoolExecutor-0_1"}


def spin_aside(simulation: Simulation, node: Node) -> None:
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    simulation.start(executor.spin, "spinner")


def test_a_rate_sleeps_in_step_with_its_timer() -> None:
    woken: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(2.0)
        spin_aside(simulation, node)
        for _ in range(2):
            rate.sleep()
            woken.append(simulation.now)
        simulation.sleep(0.1)
        rate.sleep()
        woken.append(simulation.now)
        rclpy.shutdown()

    simulate(program)
    assert woken == [0.5, 1.0, 1.5]


def test_two_threads_may_sleep_by_one_rate() -> None:
    woken: list[float] = []

    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(1.0)
        spin_aside(simulation, node)

        def sleeper() -> None:
            rate.sleep()
            woken.append(simulation.now)

        simulation.start(sleeper)
        simulation.start(sleeper)
        simulation.sleep(1.5)
        rclpy.shutdown()

    simulate(program)
    assert woken == [1.0, 1.0]


def test_a_rate_of_no_frequency_is_an_error() -> None:
    def program(simulation: Simulation) -> None:
        with pytest.raises(ValueError, match="frequency must be > 0"):
            Node("n").create_rate(0.0)

    simulate(program)


def test_a_destroyed_rate_cannot_sleep() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(1.0)
        assert node.destroy_rate(rate)
        with pytest.raises(RuntimeError, match="Rate cannot sleep because it has been destroyed"):
            rate.sleep()

    simulate(program)


def test_shutdown_interrupts_who_sleeps_by_a_rate() -> None:
    ends: list[float] = []

    def program(simulation: Simulation) -> None:
        rate = Node("n").create_rate(0.01)
        simulation.at(1.0, rclpy.shutdown)
        with pytest.raises(ROSInterruptException):
            rate.sleep()
        ends.append(simulation.now)

    simulate(program)
    assert ends == [1.0]


def test_a_rate_that_sleeps_in_a_callback_of_the_only_thread_sleeps_for_ever() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        rate = node.create_rate(0.1)
        node.create_timer(0.5, rate.sleep)
        rclpy.spin(node)

    trace = simulate(program, until=50.0)
    assert trace.times("sleep") == [0.5]

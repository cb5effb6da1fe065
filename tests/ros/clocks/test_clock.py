"""Clocks: sleeping on them, setting ROS time, and hearing of jumps; what a timer tells of its call."""

from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.ros.clocks.clock import Clock, ClockChange, ClockEvent, JumpThreshold, ROSClock, TimeJump
from sim.ros.entities.timer import TimerInfo
from sim.ros.exceptions import NotInitializedException
from sim.ros.node.node import Node
from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration, Infinite
from sim.ros.time.time import Time
from tests.support.simulation import Simulation, simulate

SECOND = Duration(seconds=1)


def ros_time(seconds: float) -> Time:
    return Time(seconds=seconds, clock_type=ClockType.ROS_TIME)


def test_a_clock_of_ros_time_is_a_ros_clock() -> None:
    assert type(Clock(clock_type=ClockType.ROS_TIME)) is ROSClock
    assert type(Clock()) is Clock
    assert ROSClock().clock_type is ClockType.ROS_TIME
    with pytest.raises(TypeError, match="Clock type must be a ClockType enum"):
        Clock(clock_type="ROS")  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", [ClockType.ROS_TIME, ClockType.SYSTEM_TIME, ClockType.STEADY_TIME])
def test_sleeping_takes_its_time(kind: ClockType) -> None:
    def program(simulation: Simulation) -> None:
        clock = Clock(clock_type=kind)
        assert clock.sleep_for(SECOND)
        assert simulation.now == 1.0
        assert clock.sleep_until(clock.now() + SECOND)
        assert clock.sleep_until(clock.now() - SECOND)
        assert simulation.now == 2.0

    simulate(program)


def test_sleeping_ends_with_the_context_and_needs_one() -> None:
    def program(simulation: Simulation) -> None:
        simulation.at(0.5, rclpy.shutdown)
        assert not Clock().sleep_for(SECOND)
        assert simulation.now == 0.5
        with pytest.raises(NotInitializedException):
            Clock().sleep_for(SECOND)

    simulate(program)


def test_nobody_sleeps_until_a_time_of_another_clock() -> None:
    def program(_: Simulation) -> None:
        with pytest.raises(ValueError, match="until's clock type does not match this clock's type"):
            Clock().sleep_until(ros_time(1))

    simulate(program)


def test_time_that_was_set_counts_while_ros_time_is_active() -> None:
    def program(simulation: Simulation) -> None:
        clock = ROSClock()
        clock.set_ros_time_override(ros_time(7))
        assert clock.now() != ros_time(7)
        clock._set_ros_time_is_active(True)
        assert clock.ros_time_is_active
        assert clock.now() == ros_time(7)
        simulation.at(1.0, lambda: clock.set_ros_time_override(ros_time(8)))
        simulation.at(2.0, lambda: clock.set_ros_time_override(ros_time(9)))
        assert clock.sleep_until(ros_time(9))
        assert simulation.now == 2.0
        simulation.at(3.0, lambda: clock._set_ros_time_is_active(False))
        assert not clock.sleep_until(ros_time(20))
        with pytest.raises(
            TypeError, match=r"Time must be specified as rclpy.time.Time. Received type: <class"
        ):
            clock.set_ros_time_override(1)  # type: ignore[arg-type]

    simulate(program)


def test_jumps_are_told_before_and_after_if_they_are_far_enough() -> None:
    clock, told = ROSClock(), []
    threshold = JumpThreshold(min_forward=SECOND, min_backward=Duration(seconds=-1), on_clock_change=True)

    def after(jump: TimeJump) -> None:
        told.append((jump.clock_change.name, jump.delta.nanoseconds, clock.now()))

    handle = clock.create_jump_callback(
        threshold, pre_callback=lambda: told.append(("before", 0, clock.now())), post_callback=after
    )
    clock.set_ros_time_override(ros_time(5))
    clock._set_ros_time_is_active(True)
    assert [each[0] for each in told] == ["before", ClockChange.ROS_TIME_ACTIVATED.name]
    told.clear()
    for seconds in (5.5, 7, 6.5, 1):
        clock.set_ros_time_override(ros_time(seconds))
    assert told == [
        ("before", 0, ros_time(5.5)),
        ("ROS_TIME_NO_CHANGE", 1_500_000_000, ros_time(7)),
        ("before", 0, ros_time(6.5)),
        ("ROS_TIME_NO_CHANGE", -5_500_000_000, ros_time(1)),
    ]
    handle.unregister()
    clock._set_ros_time_is_active(False)
    assert len(told) == 4


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"min_forward": Duration(), "min_backward": None}, "min_forward must be a positive non-zero"),
        ({"min_forward": None, "min_backward": SECOND}, "min_backward must be a negative non-zero"),
        ({"min_forward": None, "min_backward": None, "on_clock_change": False}, "At least one"),
    ],
)
def test_a_threshold_must_make_sense(arguments: Any, text: str) -> None:
    with pytest.raises(ValueError, match=text):
        JumpThreshold(**arguments)


def test_somebody_must_be_told_of_a_jump() -> None:
    threshold = JumpThreshold(min_forward=SECOND, min_backward=None)
    with pytest.raises(ValueError, match="One of pre_callback or post_callback must be callable"):
        ROSClock().create_jump_callback(threshold)


def test_an_infinite_duration_says_so() -> None:
    assert str(Infinite) == "Infinite"
    assert str(SECOND) == "1000000000 nanoseconds"


def test_a_timer_tells_when_its_call_was_due_to_whom_wants_to_know() -> None:
    told: list[TimerInfo] = []

    def tick(info: TimerInfo) -> None:
        told.append(info)

    def program(simulation: Simulation) -> None:
        node = Node("n")
        timer = node.create_timer(1.0, tick)
        simulation.sleep(1.25)
        rclpy.spin_once(node, timeout_sec=0.0)
        timer.callback = told.clear
        (info,) = told
        assert info.expected_call_time.clock_type is ClockType.ROS_TIME
        assert info.actual_call_time == node.get_clock().now()
        assert info.actual_call_time - info.expected_call_time == Duration(seconds=0.25)
        rclpy.spin_once(node, timeout_sec=1.0)
        assert not told

    simulate(program, distro="kilted")


@pytest.mark.parametrize(
    ("kind", "wait"),
    [
        (ClockType.STEADY_TIME, "wait_until_steady"),
        (ClockType.SYSTEM_TIME, "wait_until_system"),
        (ClockType.ROS_TIME, "wait_until_ros"),
    ],
)
def test_an_event_is_waited_for_until_a_time_or_until_it_is_set(kind: ClockType, wait: str) -> None:
    def program(simulation: Simulation) -> None:
        event, clock = ClockEvent(), Clock(clock_type=kind)
        wait_until = getattr(event, wait)
        wait_until(clock.handle, (clock.now() + SECOND)._time_handle)
        assert simulation.now == 1.0
        assert not event.is_set()
        simulation.at(1.5, event.set)
        simulation.start(lambda: wait_until(clock.handle, clock.now() + SECOND))
        wait_until(clock.handle, clock.now() + SECOND)
        assert simulation.now == 1.5
        assert event.is_set()
        wait_until(clock.handle, clock.now() + SECOND)
        assert simulation.now == 1.5
        event.clear()
        wait_until(clock.handle, clock.now() + SECOND)
        assert simulation.now == 2.5

    simulate(program)


def test_active_ros_time_ends_no_wait_for_an_event() -> None:
    def program(simulation: Simulation) -> None:
        event, clock = ClockEvent(), ROSClock()
        clock._set_ros_time_is_active(True)
        simulation.at(1.0, lambda: clock.set_ros_time_override(ros_time(100)))
        simulation.at(2.0, event.set)
        event.wait_until_ros(clock, ros_time(10))
        assert simulation.now == 2.0

    simulate(program)

"""Time as ``/clock`` tells it: time sources, timers, rates and sleeping on ROS time."""

from collections.abc import Callable
from typing import Any

import pytest

import sim.ros.rclpy as rclpy
from sim.interfaces import message
from sim.ros.clocks.clock import Clock, ClockChange, JumpThreshold, ROSClock, TimeJump
from sim.ros.clocks.ros_time_schedule import RosTimeSchedule, after_change
from sim.ros.entities.timer import TimerInfo
from sim.ros.node.node import Node
from sim.ros.node.time_source import TimeSource
from sim.ros.parameters.parameter import Parameter
from sim.ros.scheduling.callback_groups import MutuallyExclusiveCallbackGroup
from sim.ros.scheduling.executors import MultiThreadedExecutor, SingleThreadedExecutor
from sim.ros.time.clock_type import ClockType
from sim.ros.time.duration import Duration
from sim.ros.time.time import Time
from tests.support.simulation import Simulation, Trace, simulate

ClockMessage = message("rosgraph_msgs", "Clock")
USE_SIM_TIME = Parameter("use_sim_time", value=True)
SECOND = 1_000_000_000


def ros_time(seconds: float) -> Time:
    return Time(seconds=seconds, clock_type=ClockType.ROS_TIME)


def clock_message(seconds: float) -> Any:
    return ClockMessage(clock=ros_time(seconds).to_msg())


def sim_time_node(name: str = "n") -> Node:
    return Node(name, parameter_overrides=[USE_SIM_TIME])


def clock_publisher(simulation: Simulation, period: float, step: float) -> None:
    """Have ROS time begin at 100.125 s and go on by ``step`` seconds each ``period``, first after one."""
    publisher = simulation.outside_node("clock").create_publisher(ClockMessage, "/clock", 10)

    def run() -> None:
        count = 0
        while True:
            simulation.sleep(period)
            publisher.publish(clock_message(100.125 + count * step))
            count += 1

    simulation.start(run, "clock")


def spun(build: Callable[[Simulation, Node], object], until: float) -> Trace:
    """Spin a node that follows ``/clock``, which goes half as fast as the run."""

    def program(simulation: Simulation) -> None:
        node = sim_time_node()
        build(simulation, node)
        clock_publisher(simulation, 0.5, 0.25)
        rclpy.spin(node)

    return simulate(program, until)


# Time sources


def test_only_clocks_of_ros_time_can_be_attached() -> None:
    def program(_: Simulation) -> None:
        source = TimeSource(node=Node("n"))
        source.attach_clock(ROSClock())
        for kind in (ClockType.SYSTEM_TIME, ClockType.STEADY_TIME):
            with pytest.raises(ValueError, match="Only clocks with type ROS_TIME"):
                source.attach_clock(Clock(clock_type=kind))
        with pytest.raises(TypeError, match="Node must be of type"):
            source.attach_node("n")  # type: ignore[arg-type]

    simulate(program)


def test_without_sim_time_nobody_hears_clock() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        source, clock = TimeSource(node=node), ROSClock()
        source.attach_clock(clock)
        assert not clock.ros_time_is_active
        assert clock.now().nanoseconds == Clock().now().nanoseconds
        assert node.count_subscribers("/clock") == 0
        active = ROSClock()
        active._set_ros_time_is_active(True)
        source.attach_clock(active)
        assert not active.ros_time_is_active

    simulate(program)


def test_the_parameter_switches_between_clock_and_the_run_s_time() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        clock = node.get_clock()
        node.set_parameters([USE_SIM_TIME])
        assert clock.now() == ros_time(0)
        assert node.count_subscribers("/clock") == 1
        node.create_publisher(ClockMessage, "/clock", 1).publish(clock_message(5.5))
        rclpy.spin_once(node, timeout_sec=1.0)
        assert clock.now() == ros_time(5.5)
        node.set_parameters([Parameter("use_sim_time", value=False)])
        assert clock.now().nanoseconds == Clock().now().nanoseconds
        assert node.count_subscribers("/clock") == 0
        (result,) = node.set_parameters([Parameter("use_sim_time", value=1)])
        assert not result.successful

    simulate(program)


def test_the_command_line_asks_for_sim_time() -> None:
    def program(_: Simulation) -> None:
        node = Node("n", cli_args=["--ros-args", "-p", "use_sim_time:=true"])
        assert node.get_clock().now() == ros_time(0)

    simulate(program)


def test_a_clock_attached_late_gets_the_last_time_heard() -> None:
    def program(_: Simulation) -> None:
        node = Node("n")
        source = TimeSource(node=node)
        node.set_parameters([USE_SIM_TIME])
        publisher = node.create_publisher(ClockMessage, "/clock", 1)
        for seconds in range(1, 4):
            publisher.publish(clock_message(seconds))
            rclpy.spin_once(node, timeout_sec=1.0, executor=SingleThreadedExecutor())
        clock = ROSClock()
        source.attach_clock(clock)
        assert clock.now() == ros_time(3)
        source.detach_node()
        other = Node("other")
        source.attach_node(other)
        assert not source.ros_time_is_active
        assert not clock.ros_time_is_active

    simulate(program)


def test_jumps_come_with_clock_and_with_the_source() -> None:
    told: list[TimeJump] = []

    def program(_: Simulation) -> None:
        node = sim_time_node()
        threshold = JumpThreshold(min_forward=Duration(seconds=0.5), min_backward=Duration(seconds=-0.5))
        node.get_clock().create_jump_callback(threshold, post_callback=told.append)
        publisher = node.create_publisher(ClockMessage, "/clock", 1)
        for seconds in (10, 10.25, 8):
            publisher.publish(clock_message(seconds))
            rclpy.spin_once(node, timeout_sec=1.0)
        node.set_parameters([Parameter("use_sim_time", value=False)])

    simulate(program)
    assert [(each.clock_change, each.delta.nanoseconds / SECOND) for each in told] == [
        (ClockChange.ROS_TIME_NO_CHANGE, 10),
        (ClockChange.ROS_TIME_NO_CHANGE, -2.25),
        (ClockChange.ROS_TIME_DEACTIVATED, 0),
    ]


# Timers and rates


def test_timers_follow_clock() -> None:
    trace = spun(lambda _, node: node.create_timer(1.0, tick), until=8.0)
    # Due 1 s after time 0, so at the first message; then at 101, 102 …, each 2 s of the run.
    assert trace.times("tick") == [0.5, 2.5, 4.5, 6.5]


def test_timers_follow_clock_on_many_threads() -> None:
    def program(simulation: Simulation) -> None:
        node = sim_time_node()
        node.create_timer(1.0, tick, MutuallyExclusiveCallbackGroup())
        node.create_timer(2.0, tock, MutuallyExclusiveCallbackGroup())
        clock_publisher(simulation, 0.5, 0.25)
        executor = MultiThreadedExecutor(2)
        executor.add_node(node)
        executor.spin()

    trace = simulate(program, until=8.0)
    assert trace.times("tick") == [0.5, 2.5, 4.5, 6.5]
    assert trace.times("tock") == [0.5, 4.5]


def tick() -> None:
    """Tick."""


def test_timers_stand_still_without_clock() -> None:
    def program(simulation: Simulation) -> None:
        node = sim_time_node()
        node.create_timer(0.1, tick)
        node.create_timer(2.0, tock, clock=Clock(clock_type=ClockType.STEADY_TIME))
        simulation.sleep(1.0)
        rclpy.spin(node)

    trace = simulate(program, until=5.0)
    assert trace.times("tick") == []
    assert trace.times("tock") == [2.0, 4.0]


def tock() -> None:
    """Tick on another clock."""


def test_a_tick_due_at_the_very_time_of_a_late_call_is_missed() -> None:
    def build(_: Simulation, node: Node) -> None:
        node.create_timer(0.125, tick)

    trace = spun(build, until=2.2)
    # Every message moves time by two periods.
    assert trace.times("tick") == [0.5, 1.0, 1.5, 2.0]


def test_a_timer_tells_ros_time() -> None:
    told: list[TimerInfo] = []

    def program(_: Simulation) -> None:
        node = sim_time_node()
        clock = node.get_clock()
        assert isinstance(clock, ROSClock)
        clock.set_ros_time_override(ros_time(10))

        def call(info: TimerInfo) -> None:
            told.append(info)

        timer = node.create_timer(2.0, call)
        assert timer.time_until_next_call() == 2 * SECOND
        clock.set_ros_time_override(ros_time(11))
        assert (timer.time_until_next_call(), timer.time_since_last_call()) == (SECOND, SECOND)
        assert not timer.is_ready()
        clock.set_ros_time_override(ros_time(15))
        assert timer.is_ready()
        rclpy.spin_once(node, timeout_sec=0.0)
        assert timer.time_until_next_call() == SECOND
        timer.reset()
        assert timer.time_until_next_call() == 2 * SECOND
        timer.cancel()
        clock.set_ros_time_override(ros_time(30))
        assert not timer.is_ready()

    simulate(program, distro="kilted")
    (info,) = told
    assert (info.expected_call_time, info.actual_call_time) == (ros_time(12), ros_time(15))


def test_a_timer_begins_anew_when_time_goes_back_beyond_its_last_call() -> None:
    def program(_: Simulation) -> None:
        node = sim_time_node()
        clock = node.get_clock()
        assert isinstance(clock, ROSClock)
        clock.set_ros_time_override(ros_time(10))
        timer = node.create_timer(4.0, tick)
        clock.set_ros_time_override(ros_time(14))
        rclpy.spin_once(node, timeout_sec=0.0)
        clock.set_ros_time_override(ros_time(17))
        clock.set_ros_time_override(ros_time(15))
        assert timer.time_until_next_call() == 3 * SECOND
        clock.set_ros_time_override(ros_time(5))
        assert timer.time_until_next_call() == 4 * SECOND

    simulate(program)


def test_a_timer_that_time_took_back_is_not_called() -> None:
    def program(_: Simulation) -> None:
        node = sim_time_node()
        clock = node.get_clock()
        assert isinstance(clock, ROSClock)
        clock.set_ros_time_override(ros_time(10))
        node.create_timer(4.0, tick)
        clock.set_ros_time_override(ros_time(14))
        clock.set_ros_time_override(ros_time(12))
        rclpy.spin_once(node, timeout_sec=0.0)

    assert simulate(program).times("tick") == []


def test_a_timer_survives_a_change_of_its_clock_s_source() -> None:
    def program(simulation: Simulation) -> None:
        node = Node("n")
        node.create_timer(1.0, tick)
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        simulation.at(2.5, lambda: node.set_parameters([USE_SIM_TIME]))
        simulation.at(5.25, lambda: node.set_parameters([Parameter("use_sim_time", value=False)]))
        executor.spin()

    # Half a second was left of the period when time was lost, so as much of it has passed when time is back.
    assert simulate(program, until=8.0).times("tick") == [1.0, 2.0, 5.75, 6.75, 7.75]


def test_the_credit_of_a_timer_is_spent_once_time_is_known() -> None:
    schedule = RosTimeSchedule(due=70, last_call=60)
    assert after_change(schedule, now=0, period=10, credit=4) == RosTimeSchedule(70, 60, credit=4)
    assert after_change(schedule, now=500, period=10, credit=0) is schedule
    assert after_change(schedule, now=500, period=10, credit=4) == RosTimeSchedule(506, 496)


def test_a_rate_sleeps_by_clock() -> None:
    woken: list[float] = []

    def build(simulation: Simulation, node: Node) -> None:
        rate = node.create_rate(1.0)

        def run() -> None:
            for _ in range(3):
                rate.sleep()
                woken.append(simulation.now)

        simulation.start(run)

    spun(build, until=8.0)
    assert woken == [0.5, 2.5, 4.5]


@pytest.mark.parametrize(
    ("back_to", "woken"),
    [
        # Beyond the timer's last call, and not: as on rclpy 7.1.6.
        (3.0, [10.5, 3.5, 4.0]),
        (10.625, [10.5, 11.125, 11.625]),
    ],
)
def test_a_rate_sleeps_on_when_the_clock_is_set_back(back_to: float, woken: list[float]) -> None:
    heard: list[float] = []

    def program(simulation: Simulation) -> None:
        node = sim_time_node()
        clock = node.get_clock()
        assert isinstance(clock, ROSClock)
        clock.set_ros_time_override(ros_time(10.0))
        rate = node.create_rate(2.0)

        def sleep() -> None:
            for _ in range(3):
                rate.sleep()
                heard.append(clock.now().nanoseconds / SECOND)

        def go_on() -> None:
            before = [10.25, 10.5, 10.75]
            after = [back_to + 0.25 * each for each in range(7)]
            for each in (*before, *after):
                simulation.sleep(0.5)
                clock.set_ros_time_override(ros_time(each))

        simulation.start(sleep)
        simulation.start(go_on)
        rclpy.spin(node)

    simulate(program, until=8.0)
    assert heard == woken


def test_a_callback_of_the_default_group_that_waits_for_ros_time_waits_for_ever() -> None:
    def build(_: Simulation, node: Node) -> None:
        node.create_timer(1.0, lambda: node.get_clock().sleep_for(Duration(seconds=1)))

    trace = spun(build, until=20.0)
    assert [each.name for each in trace.calls()].count("<lambda>") == 1


# Sleeping


def test_sleeping_on_ros_time_follows_clock() -> None:
    def program(simulation: Simulation) -> None:
        node = sim_time_node()
        clock_publisher(simulation, 0.5, 0.25)
        simulation.spin_outside(node)
        simulation.sleep(0.75)
        assert node.get_clock().sleep_for(Duration(seconds=1))
        assert simulation.now == 2.5
        assert node.get_clock().now() == ros_time(101.125)

    simulate(program)


@pytest.mark.parametrize("active", [True, False])
def test_a_change_of_the_source_ends_a_sleep(active: bool) -> None:
    def program(simulation: Simulation) -> None:
        clock = ROSClock()
        clock._set_ros_time_is_active(not active)
        simulation.at(0.2, lambda: clock._set_ros_time_is_active(active))
        assert not clock.sleep_for(Duration(seconds=10))
        assert simulation.now == 0.2

    simulate(program)


def test_a_sleep_leaves_nothing_behind_in_the_context() -> None:
    def program(_: Simulation) -> None:
        context = rclpy.get_default_context()
        before = len(context._end_callbacks)
        clock = Clock()
        for _each in range(5):
            clock.sleep_for(Duration(seconds=0.1))
        assert len(context._end_callbacks) == before

    simulate(program)

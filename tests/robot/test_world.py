"""How the robot moves, stops, touches and is reset."""

import math
from collections.abc import Callable
from contextlib import closing

import numpy as np
import pytest

from sim.robot.arena import ARENA, ROBOT_RADIUS, START, Arena, Circle, Segment
from sim.robot.drive import MAX_ANGULAR, MAX_LINEAR, STANDSTILL
from sim.robot.lidar import BEAMS
from sim.robot.world import World
from tests.robot.conftest import MakeWorld

AHEAD = BEAMS // 2
OUT_OF_SIGHT = Circle(0.0, -50.0, 0.1)


def seconds(count: float) -> int:
    return round(count * 1_000_000_000)


def wall_ahead(distance: float) -> Arena:
    return Arena((Segment(distance, -3.0, distance, 3.0),), OUT_OF_SIGHT)


def open_floor() -> Arena:
    return wall_ahead(100.0)


def drive_about(world: World, until: float) -> None:
    """Drive every which way, into the sphere too, with commands at moments between steps."""
    commands = [(0.2, 0.0), (0.2, 1.3), (-0.1, -2.0), (0.0, -0.2), (0.22, 0.1)]
    for tick in range(round(until / 0.37)):
        world.command(*commands[tick % len(commands)])
        world.advance_to(seconds((tick + 1) * 0.37))


def state(world: World) -> tuple[object, ...]:
    sensed = (world.pose(), world.velocity(), world.wheel_angles(), world.scan().tobytes())
    return (*sensed, world.turned, world.travelled, world.touching())


def test_the_robot_starts_at_the_origin_at_rest_facing_along_x(world: World) -> None:
    pose = world.pose()
    assert (pose.x, pose.y, pose.yaw) == pytest.approx((START.x, START.y, START.yaw), abs=1e-6)
    assert world.velocity() == pytest.approx(STANDSTILL, abs=1e-6)
    assert world.wheel_angles() == pytest.approx((0.0, 0.0), abs=1e-6)
    assert world.scan()[AHEAD] == pytest.approx(0.75, abs=1e-3)
    assert not world.touching()


def test_ten_seconds_at_eight_centimetres_a_second_are_eighty_centimetres(make_world: MakeWorld) -> None:
    with closing(make_world(open_floor())) as world:
        world.command(0.08, 0.0)
        world.advance_to(seconds(10))
        pose = world.pose()
        assert pose.x == pytest.approx(0.80, rel=0.005)
        assert abs(pose.y) < 1e-3
        assert abs(pose.yaw) < 1e-3
        assert world.travelled == pytest.approx(pose.x, rel=1e-3)
        assert world.velocity() == pytest.approx((0.08, 0.0), abs=1e-3)


def test_ten_seconds_of_turning_at_a_fifth_are_two_radians_on_the_spot(world: World) -> None:
    world.command(0.0, -0.2)
    world.advance_to(seconds(10))
    pose = world.pose()
    assert pose.yaw == pytest.approx(-2.0, rel=0.005)
    assert math.hypot(pose.x, pose.y) < 1e-3
    assert world.velocity() == pytest.approx((0.0, -0.2), abs=1e-3)


def test_the_turned_angle_counts_whole_turns_and_their_sign(world: World) -> None:
    world.command(0.0, 2.0)
    world.advance_to(seconds(10))
    assert world.turned == pytest.approx(20.0, rel=0.02)
    world.command(0.0, -2.0)
    world.advance_to(seconds(20))
    assert world.turned == pytest.approx(0.0, abs=0.5)


def test_an_arc_is_driven_as_wide_as_the_two_speeds_say(make_world: MakeWorld) -> None:
    with closing(make_world(open_floor())) as world:
        world.command(0.1, 0.5)
        world.advance_to(seconds(math.pi / 0.5))
        assert world.pose().y == pytest.approx(2 * 0.1 / 0.5, rel=0.02)


def test_ranges_360_reads_the_distance_to_a_wall_one_metre_ahead(make_world: MakeWorld) -> None:
    with closing(make_world(wall_ahead(1.0))) as world:
        assert world.scan()[AHEAD] == pytest.approx(1.00, abs=0.02)
        world.command(0.1, 0.0)
        world.advance_to(seconds(5))
        assert world.scan()[AHEAD] == pytest.approx(0.50, abs=0.02)


def test_stop_means_stop(world: World) -> None:
    world.command(0.22, 2.0)
    world.advance_to(seconds(2))
    world.command(0.0, 0.0)
    world.advance_to(seconds(2.5))
    stopped, turned = world.pose(), world.turned
    world.advance_to(seconds(12.5))
    assert math.hypot(world.pose().x - stopped.x, world.pose().y - stopped.y) < 1e-4
    assert world.turned == pytest.approx(turned, abs=1e-4)


def test_a_command_beyond_the_limits_is_clamped(world: World) -> None:
    assert world.command(-5.0, 50.0)
    assert world.commanded == (-MAX_LINEAR, MAX_ANGULAR)
    world.advance_to(seconds(1))
    assert world.velocity() == pytest.approx((-MAX_LINEAR, MAX_ANGULAR), rel=0.02)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_a_command_that_is_no_number_changes_nothing(world: World, odd: float) -> None:
    world.command(0.1, 0.0)
    assert not world.command(odd, 0.0)
    assert not world.command(0.0, odd)
    assert world.commanded == (0.1, 0.0)
    world.advance_to(seconds(1))
    assert world.velocity() == pytest.approx((0.1, 0.0), abs=1e-3)


def test_without_motors_the_robot_rolls_to_a_stop_soon_and_obeys_nothing(world: World) -> None:
    world.command(0.2, 0.0)
    world.advance_to(seconds(1))
    world.set_motors(on=False)
    cut = world.pose().x
    world.advance_to(seconds(1.05))
    assert 0.05 < world.velocity().linear < 0.2
    world.advance_to(seconds(2))
    assert cut + 0.01 < world.pose().x < cut + 0.1
    assert world.command(0.2, 0.0)
    stood = world.pose().x
    world.advance_to(seconds(5))
    assert world.pose().x == pytest.approx(stood, abs=1e-4)
    assert world.commanded == STANDSTILL


def test_motors_that_come_back_move_the_robot_only_on_a_new_command(world: World) -> None:
    world.command(0.2, 0.0)
    world.set_motors(on=False)
    world.command(0.2, 0.0)
    world.set_motors(on=True)
    world.advance_to(seconds(1))
    assert world.travelled < 1e-4
    world.command(0.1, 0.0)
    world.advance_to(seconds(2))
    assert world.travelled == pytest.approx(0.1, rel=0.1)


def test_power_that_was_there_already_does_not_forget_the_command(world: World) -> None:
    world.command(0.1, 0.0)
    world.set_motors(on=True)
    assert world.commanded == (0.1, 0.0)


@pytest.mark.parametrize("heading", [0.0, 0.7])
def test_a_wall_stops_the_robot_and_is_felt(heading: float, make_world: MakeWorld) -> None:
    with closing(make_world(wall_ahead(0.5))) as world:
        world.command(0.0, heading)
        world.advance_to(seconds(1))
        assert not world.touching()
        world.command(MAX_LINEAR, 0.0)
        for tick in range(200):
            world.advance_to(seconds(1 + tick / 20))
            assert world.pose().x < 0.5 - ROBOT_RADIUS + 0.002
        assert world.touching()
        world.command(-MAX_LINEAR, 0.0)
        world.advance_to(seconds(13))
        assert not world.touching()


def test_the_sphere_stops_the_robot_and_is_felt(world: World) -> None:
    world.command(0.1, 0.0)
    world.advance_to(seconds(10))
    assert world.touching()
    gap = math.hypot(world.pose().x - ARENA.sphere.x, world.pose().y - ARENA.sphere.y)
    assert gap == pytest.approx(ARENA.sphere.radius + ROBOT_RADIUS, abs=0.005)


def test_reset_brings_the_robot_back_to_the_start_at_rest_and_lets_the_counters_be(
    world: World, make_world: MakeWorld
) -> None:
    drive_about(world, until=4.0)
    world.advance_to(seconds(5))
    turned, travelled = world.turned, world.travelled
    world.reset()
    assert world.commanded == STANDSTILL
    assert (world.turned, world.travelled) == (turned, travelled)
    with closing(make_world()) as fresh:
        assert (world.pose(), world.velocity(), world.wheel_angles()) == (
            fresh.pose(),
            fresh.velocity(),
            fresh.wheel_angles(),
        )
        for each, start in ((world, seconds(5)), (fresh, 0)):
            each.command(0.1, -0.3)
            each.advance_to(start + seconds(2))
        assert world.pose() == fresh.pose()


def test_time_goes_on_over_a_reset(world: World) -> None:
    world.advance_to(seconds(10))
    world.reset()
    world.command(0.1, 0.0)
    world.advance_to(seconds(10))
    assert world.travelled == pytest.approx(0.0, abs=1e-6)
    world.advance_to(seconds(11))
    assert world.travelled == pytest.approx(0.1, rel=0.05)


def test_the_same_commands_give_the_same_bits(make_world: MakeWorld) -> None:
    with closing(make_world()) as first, closing(make_world()) as second:
        drive_about(first, until=12.0)
        drive_about(second, until=12.0)
        assert state(first) == state(second)


def test_two_worlds_in_one_process_leave_each_other_alone(make_world: MakeWorld) -> None:
    with closing(make_world()) as alone:
        drive_about(alone, until=4.0)
        expected = state(alone)
    with closing(make_world()) as one, closing(make_world(wall_ahead(0.3))) as other:
        other.command(0.2, 1.0)
        for tick in range(40):
            other.advance_to(seconds(tick / 10))
        drive_about(one, until=4.0)
        assert state(one) == expected


def every(step: float) -> Callable[[World, int], None]:
    def advance(world: World, until: int) -> None:
        for time in range(0, until, seconds(step)):
            world.advance_to(time)
        world.advance_to(until)

    return advance


@pytest.mark.parametrize("advance", [every(0.05), every(0.001), every(0.0317)])
def test_how_the_time_is_sliced_changes_nothing(
    advance: Callable[[World, int], None], make_world: MakeWorld
) -> None:
    with closing(make_world()) as whole, closing(make_world()) as sliced:
        for world in (whole, sliced):
            world.command(0.2, 0.4)
        whole.advance_to(seconds(5.01))
        advance(sliced, seconds(5.01))
        assert state(sliced) == state(whole)


def test_a_step_runs_at_its_nanosecond_and_not_before(world: World) -> None:
    def wheel_after(time: int) -> float:
        world.advance_to(time)
        return world.wheel_angles().right

    world.command(0.2, 0.0)
    third_step = 12_500_000
    second_step = 8_333_333
    assert wheel_after(second_step - 1) < wheel_after(second_step) == wheel_after(third_step - 1)
    assert wheel_after(third_step - 1) < wheel_after(third_step)


def test_a_time_gone_by_runs_no_step(world: World) -> None:
    world.command(0.2, 0.0)
    world.advance_to(seconds(1))
    here = world.pose()
    world.advance_to(seconds(0.5))
    world.advance_to(-seconds(1))
    assert world.pose() == here


def test_a_scan_comes_from_where_the_robot_is(world: World) -> None:
    world.command(0.1, 0.0)
    world.advance_to(seconds(2))
    gap = ARENA.sphere.x - ARENA.sphere.radius - world.pose().x
    assert world.scan()[AHEAD] == pytest.approx(gap, abs=1e-3)
    assert not np.isnan(world.scan()).any()

"""Differential drive, as plain arithmetic."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.robot.drive import (
    MAX_ANGULAR,
    MAX_LINEAR,
    WHEEL_RADIUS,
    WHEEL_SEPARATION,
    Velocity,
    clamped,
    is_drivable,
    wheel_speeds,
)

speeds = st.floats(-100, 100)


@given(speeds, speeds)
def test_the_wheels_speeds_are_those_of_a_body_that_does_not_slip(linear: float, angular: float) -> None:
    wheels = wheel_speeds(Velocity(linear, angular))
    assert (wheels.left + wheels.right) * WHEEL_RADIUS / 2 == pytest.approx(linear, abs=1e-9)
    assert (wheels.right - wheels.left) * WHEEL_RADIUS / WHEEL_SEPARATION == pytest.approx(angular, abs=1e-9)


def test_turning_counter_clockwise_runs_the_right_wheel_forward() -> None:
    wheels = wheel_speeds(Velocity(0.0, 1.0))
    assert wheels.left < 0 < wheels.right


@given(speeds, speeds)
def test_clamping_keeps_what_is_within_the_limits_and_cuts_the_rest(linear: float, angular: float) -> None:
    kept = clamped(Velocity(linear, angular))
    assert abs(kept.linear) <= MAX_LINEAR
    assert abs(kept.angular) <= MAX_ANGULAR
    assert kept.linear == linear or abs(kept.linear) == MAX_LINEAR < abs(linear)
    assert kept.angular == angular or abs(kept.angular) == MAX_ANGULAR < abs(angular)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf])
def test_neither_nan_nor_infinity_is_a_velocity(odd: float) -> None:
    assert not is_drivable(Velocity(odd, 0.0))
    assert not is_drivable(Velocity(0.0, odd))
    assert is_drivable(Velocity(1e9, -1e9))

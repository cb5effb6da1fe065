"""Differential drive: the wheel speeds of a body velocity, and the robot's limits."""

import math
from typing import NamedTuple

WHEEL_RADIUS = 0.033
WHEEL_SEPARATION = 0.160

STEP_RATE = 240
"""Steps a second of the physics."""

MOTOR_TORQUE = 0.02
"""Newton metres of each wheel: full speed within 0.2 s, and too weak to lift the robot against a wall."""

MAX_LINEAR = 0.22
"""Fastest a TurtleBot3 Burger drives, in m/s, by its data sheet."""

MAX_ANGULAR = 2.84
"""Fastest a TurtleBot3 Burger turns, in rad/s, by its data sheet."""


class Velocity(NamedTuple):
    """A velocity of the body: forward in m/s, and counter-clockwise in rad/s."""

    linear: float
    angular: float


STANDSTILL = Velocity(0.0, 0.0)


class WheelPair(NamedTuple):
    """One figure for each wheel: an angle in rad, or a speed in rad/s, positive forward."""

    left: float
    right: float


def is_drivable(wanted: Velocity) -> bool:
    """Return whether a velocity is finite."""
    return math.isfinite(wanted.linear) and math.isfinite(wanted.angular)


def clamped(wanted: Velocity) -> Velocity:
    """Clamp each component of a velocity to the robot's limits."""
    return Velocity(
        max(-MAX_LINEAR, min(MAX_LINEAR, wanted.linear)), max(-MAX_ANGULAR, min(MAX_ANGULAR, wanted.angular))
    )


def wheel_speeds(body: Velocity) -> WheelPair:
    """Return the wheel speeds, in rad/s, for a velocity of the body without slip."""
    lag = body.angular * WHEEL_SEPARATION / 2
    return WheelPair((body.linear - lag) / WHEEL_RADIUS, (body.linear + lag) / WHEEL_RADIUS)

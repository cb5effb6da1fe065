"""The headless robot world: physics in steps of 1/240 s, advanced by the caller's clock."""

import math

import numpy as np
from numpy.typing import NDArray

from sim.quantities.nanoseconds import SECOND

from .arena import ARENA, Arena, Pose
from .drive import MOTOR_TORQUE, STANDSTILL, STEP_RATE, Velocity, clamped, is_drivable, wheel_speeds
from .lidar import Lidar
from .physics import PhysicsChoice, build

_GEAR_DRAG = 0.01
"""Newton metres with which the gear of a motor without power brakes its wheel."""

_STEPS_PER_SAMPLE = 12
"""Steps between two samples of the pose for the counters; fixed, so that queries do not change them."""


class World:
    """A room, a sphere and a robot.

    Only the motors of its wheels and friction move the robot, except for `reset`. The same calls at the same
    times give the same bits. Times are integer nanoseconds since the world was built. Not thread-safe: one
    thread at a time.

    ``commanded`` is the target velocity of the body: clamped, and zero while the motors are off.
    """

    def __init__(self, arena: Arena = ARENA, physics: PhysicsChoice | None = None) -> None:
        """Build the world, with the robot at rest at the start; ``physics`` None: the usual one.

        Raises:
            WorldUnavailable: PyBullet cannot be used here; the text says what to do.
        """
        self._physics = build(arena, physics)
        self.pose = self._physics.pose
        self.velocity = self._physics.velocity
        self.wheel_angles = self._physics.wheel_angles
        self.touching = self._physics.touching
        self._lidar = Lidar(arena)
        self.motors_on = True
        self._turn_wheels(STANDSTILL)
        self._steps = 0
        self._turned = 0.0
        self._travelled = 0.0
        self._sampled = self.pose()

    @property
    def turned(self) -> float:
        """Signed rotation since the world was built, in rad, counter-clockwise positive."""
        return self._turned + _turn_between(self._sampled, self.pose())

    @property
    def travelled(self) -> float:
        """Length of the path of the base since the world was built, in metres."""
        return self._travelled + _distance_between(self._sampled, self.pose())

    def command(self, linear: float, angular: float) -> bool:
        """Set the target velocity of the body (m/s, rad/s), clamped to the robot's limits.

        Returns False for NaN and infinity, which are ignored. A command is lost while the motors are off,
        as on a robot whose motor driver is off.
        """
        wanted = Velocity(linear, angular)
        if not is_drivable(wanted):
            return False
        if self.motors_on:
            self._turn_wheels(clamped(wanted))
        return True

    def set_motors(self, on: bool) -> None:
        """Switch the motors on or off.

        When off, the gears brake the wheels within some tenths of a second. When on again, the robot stands
        until the next command.
        """
        if on == self.motors_on:
            return
        self.motors_on = on
        self._turn_wheels(STANDSTILL)

    def advance_to(self, time_ns: int) -> None:
        """Run every step that is due at a time; none for an earlier time.

        Step k is due at k / 240 s, rounded to the nanosecond.
        """
        step = self._physics.step
        due = _steps_due(time_ns)
        while self._steps < due:
            sample = self._steps - self._steps % _STEPS_PER_SAMPLE + _STEPS_PER_SAMPLE
            until = min(due, sample)
            for _ in range(until - self._steps):
                step()
            self._steps = until
            if until == sample:
                self._sample()

    def scan(self) -> NDArray[np.float32]:
        """Return the lidar's current scan, in metres, shape (720,); see `Lidar.scan`."""
        return self._lidar.scan(self.pose())

    def reset(self) -> None:
        """Put the robot back to the start, at rest and without a command; time and counters continue."""
        self._sample()
        self._physics.reset()
        self._sampled = self.pose()
        self._turn_wheels(STANDSTILL)

    def close(self) -> None:
        """Release the physics; idempotent. The world cannot be used afterwards."""
        self._physics.close()

    def _turn_wheels(self, body: Velocity) -> None:
        self.commanded = body
        torque = MOTOR_TORQUE if self.motors_on else _GEAR_DRAG
        self._physics.turn_wheels(wheel_speeds(body), torque)

    def _sample(self) -> None:
        now = self.pose()
        self._turned += _turn_between(self._sampled, now)
        self._travelled += _distance_between(self._sampled, now)
        self._sampled = now


def _steps_due(time_ns: int) -> int:
    # The greatest k for which k / 240 s, rounded to the nanosecond, is not after the time.
    return (STEP_RATE * (2 * time_ns + 1) - 1) // (2 * SECOND)


def _turn_between(before: Pose, after: Pose) -> float:
    return math.remainder(after.yaw - before.yaw, math.tau)


def _distance_between(before: Pose, after: Pose) -> float:
    return math.hypot(after.x - before.x, after.y - before.y)

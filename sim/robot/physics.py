"""The physics of the robot: PyBullet, or a planar model in numpy where PyBullet has no wheel."""

from enum import StrEnum
from importlib.util import find_spec
from typing import Protocol

from .arena import Arena, Pose
from .drive import Velocity, WheelPair


class PhysicsChoice(StrEnum):
    """The kind of physics."""

    PYBULLET = "pybullet"
    NUMPY = "numpy"


class Physics(Protocol):
    """An arena with a robot in it, at the start and at rest. Not thread-safe: one thread at a time."""

    def step(self) -> None:
        """Simulate one step."""

    def turn_wheels(self, speeds: WheelPair, torque: float) -> None:
        """Set each wheel's target speed (rad/s), and the highest torque of both (newton metres)."""

    def pose(self) -> Pose:
        """Return the pose of the robot's base."""

    def velocity(self) -> Velocity:
        """Return the velocity of the body: along its heading, and about its axis."""

    def wheel_angles(self) -> WheelPair:
        """Return how far each wheel has turned since the start or the last reset, in rad."""

    def touching(self) -> bool:
        """Return whether the robot touched anything but the floor at the last step."""

    def reset(self) -> None:
        """Put the robot back to the start, at rest."""

    def close(self) -> None:
        """Release its resources; idempotent."""


def usual() -> PhysicsChoice:
    """Return the physics of a run without a choice: PyBullet if it is installed, else numpy."""
    return PhysicsChoice.NUMPY if find_spec("pybullet") is None else PhysicsChoice.PYBULLET


def build(arena: Arena, choice: PhysicsChoice | None = None) -> Physics:
    """Build an arena; ``choice`` None: the usual physics.

    Raises:
        WorldUnavailable: PyBullet cannot be used here; the text says what to do.
    """
    if (choice or usual()) is PhysicsChoice.NUMPY:
        from .planar_physics import PlanarPhysics

        return PlanarPhysics(arena)
    from .bullet_physics import BulletPhysics

    return BulletPhysics(arena)

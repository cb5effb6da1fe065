"""Rigid motions: a rotation about the origin, then a translation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from transforms3d.quaternions import qconjugate, qmult, qpow, rotate_vector

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Takes points of one frame to another: turned by ``rotation`` (w, x, y, z), then moved, in metres."""

    rotation: Vector
    translation: Vector

    @classmethod
    def of(cls, translation: Any, rotation: Any) -> Motion:
        """The motion of a message's translation or position, and of its rotation or orientation."""
        return cls(
            np.array((rotation.w, rotation.x, rotation.y, rotation.z)),
            np.array((translation.x, translation.y, translation.z)),
        )

    def write(self, translation: Any, rotation: Any) -> None:
        """Set the fields of two messages, as `of` reads them."""
        translation.x, translation.y, translation.z = map(float, self.translation)
        rotation.w, rotation.x, rotation.y, rotation.z = map(float, self.rotation)

    def __call__(self, point: Vector) -> Vector:
        """The point, in the frame that this motion takes to."""
        return self.turned(point) + self.translation

    def turned(self, vector: Vector) -> Vector:
        """The vector, turned and not moved."""
        turned: Vector = rotate_vector(vector, self.rotation)
        return turned

    def after(self, first: Motion) -> Motion:
        """The motion that is ``first``, and then this one."""
        return Motion(qmult(self.rotation, first.rotation), self(first.translation))

    def inverse(self) -> Motion:
        """The way back."""
        back = qconjugate(self.rotation)
        return Motion(back, -rotate_vector(self.translation, back))

    def towards(self, other: Motion, share: float) -> Motion:
        """This motion, a share from 0 to 1 of the shortest way to another."""
        between = qmult(qconjugate(self.rotation), other.rotation)
        shortest = between if between[0] >= 0 else -between
        return Motion(
            qmult(self.rotation, qpow(shortest, share)),
            self.translation + share * (other.translation - self.translation),
        )

    def same_as(self, other: Motion) -> bool:
        """Whether all numbers are equal."""
        return bool(
            np.array_equal(self.rotation, other.rotation)
            and np.array_equal(self.translation, other.translation)
        )


IDENTITY = Motion(np.array((1.0, 0.0, 0.0, 0.0)), np.zeros(3))

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
    """Converts points of one frame to another: a rotation (w, x, y, z), then a translation in metres."""

    rotation: Vector
    translation: Vector

    @classmethod
    def of(cls, translation: Any, rotation: Any) -> Motion:
        """The motion of a message's translation (or position) and rotation (or orientation)."""
        return cls(
            np.array((rotation.w, rotation.x, rotation.y, rotation.z)),
            np.array((translation.x, translation.y, translation.z)),
        )

    def write(self, translation: Any, rotation: Any) -> None:
        """Set the fields of two messages, as `of` reads them."""
        translation.x, translation.y, translation.z = map(float, self.translation)
        rotation.w, rotation.x, rotation.y, rotation.z = map(float, self.rotation)

    def __call__(self, point: Vector) -> Vector:
        """Rotate and translate a point."""
        return self.turned(point) + self.translation

    def turned(self, vector: Vector) -> Vector:
        """Rotate a vector without translation."""
        turned: Vector = rotate_vector(vector, self.rotation)
        return turned

    def after(self, first: Motion) -> Motion:
        """The composition: ``first``, then this motion."""
        return Motion(qmult(self.rotation, first.rotation), self(first.translation))

    def inverse(self) -> Motion:
        """The inverse motion."""
        back = qconjugate(self.rotation)
        return Motion(back, -rotate_vector(self.translation, back))

    def towards(self, other: Motion, share: float) -> Motion:
        """The motion at a share, from 0 to 1, of the shortest way to another motion."""
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

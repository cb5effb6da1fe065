"""``tf_transformations``: matrices, quaternions and Euler angles, computed by transforms3d.

Quaternions are ``x, y, z, w`` here, as in messages; transforms3d has ``w`` first. Matrices are 4 by 4, angles
in radians, and ``axes`` names an order of rotations: ``sxyz`` about fixed axes, ``rzyx`` about turning ones.
"""

import math
from functools import reduce
from typing import Any

import numpy as np
import numpy.typing as npt
from transforms3d import affines, axangles, euler, quaternions, reflections, shears, zooms

__all__ = [
    "compose_matrix",
    "concatenate_matrices",
    "decompose_matrix",
    "euler_from_matrix",
    "euler_from_quaternion",
    "euler_matrix",
    "identity_matrix",
    "inverse_matrix",
    "is_same_transform",
    "quaternion_about_axis",
    "quaternion_conjugate",
    "quaternion_from_euler",
    "quaternion_from_matrix",
    "quaternion_inverse",
    "quaternion_matrix",
    "quaternion_multiply",
    "quaternion_slerp",
    "random_quaternion",
    "random_rotation_matrix",
    "random_vector",
    "reflection_from_matrix",
    "reflection_matrix",
    "rotation_from_matrix",
    "rotation_matrix",
    "scale_from_matrix",
    "scale_matrix",
    "shear_from_matrix",
    "shear_matrix",
    "translation_from_matrix",
    "translation_matrix",
    "unit_vector",
    "vector_norm",
]

Array = npt.NDArray[np.float64]


def _w_first(quaternion: Any) -> Array:
    x, y, z, w = quaternion
    return np.array((w, x, y, z), dtype=np.float64)


def _w_last(quaternion: Any) -> Array:
    w, x, y, z = quaternion
    return np.array((x, y, z, w), dtype=np.float64)


def _affine(rotation: Any = None, translation: Any = (0.0, 0.0, 0.0)) -> Array:
    made: Array = affines.compose(translation, np.eye(3) if rotation is None else rotation, np.ones(3))
    return made


def identity_matrix() -> Array:
    """The identity matrix."""
    return np.eye(4)


def translation_matrix(direction: Any) -> Array:
    """The translation by a vector."""
    return _affine(translation=direction)


def translation_from_matrix(matrix: Any) -> Array:
    """The translation vector of a matrix."""
    return np.array(matrix, dtype=np.float64)[:3, 3]


def rotation_matrix(angle: float, direction: Any, point: Any = None) -> Array:
    """The rotation by an angle about an axis, through a point if one is given."""
    made: Array = axangles.axangle2aff(direction[:3], angle, point=None if point is None else point[:3])
    return made


def rotation_from_matrix(matrix: Any) -> tuple[float, Array, Array]:
    """Angle, axis and a point on the axis of a rotation; ValueError if the matrix is not a rotation."""
    direction, angle, point = axangles.aff2axangle(np.asarray(matrix))
    return angle, direction, point


def reflection_matrix(point: Any, normal: Any) -> Array:
    """The reflection at the plane through a point."""
    made: Array = reflections.rfnorm2aff(normal[:3], point[:3])
    return made


def reflection_from_matrix(matrix: Any) -> tuple[Array, Array]:
    """A point and the normal of the plane of a reflection."""
    normal, point = reflections.aff2rfnorm(np.asarray(matrix))
    return point, normal


def scale_matrix(factor: float, origin: Any = None, direction: Any = None) -> Array:
    """The scaling by a factor about a point, in one direction if one is given."""
    made: Array = zooms.zfdir2aff(factor, direction=direction, origin=origin)
    return made


def scale_from_matrix(matrix: Any) -> tuple[float, Array, Array | None]:
    """Factor, origin and direction of a scaling."""
    factor, direction, origin = zooms.aff2zfdir(np.asarray(matrix))
    return factor, origin, direction


def shear_matrix(angle: float, direction: Any, point: Any, normal: Any) -> Array:
    """The shear by an angle along a direction, on the plane through a point."""
    made: Array = shears.sadn2mat(angle, direction[:3], normal[:3])
    moved = _affine(made)
    moved[:3, 3] = np.asarray(point[:3]) - made @ np.asarray(point[:3])
    return moved


def shear_from_matrix(matrix: Any) -> tuple[float, Array, Array, Array]:
    """Angle, direction, a point and the normal of a shear."""
    angle, direction, normal, point = shears.aff2sadn(np.asarray(matrix))
    return angle, direction, point, normal


def concatenate_matrices(*matrices: Any) -> Array:
    """The product of matrices: the last is applied first."""
    return reduce(np.dot, matrices, identity_matrix())


def inverse_matrix(matrix: Any) -> Array:
    """The inverse of a matrix."""
    return np.linalg.inv(matrix)


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Whether two matrices are the same transform, up to rounding."""
    first, second = (np.array(each, dtype=np.float64) for each in (matrix0, matrix1))
    return bool(np.allclose(first / first[3, 3], second / second[3, 3]))


def compose_matrix(
    scale: Any = None, shear: Any = None, angles: Any = None, translate: Any = None, perspective: Any = None
) -> Array:
    """The matrix that scales, shears, rotates by Euler angles and translates, in this order."""
    made: Array = affines.compose(
        np.zeros(3) if translate is None else translate,
        np.eye(3) if angles is None else euler.euler2mat(*angles, axes="sxyz"),
        np.ones(3) if scale is None else scale,
        shear,
    )
    if perspective is not None:
        lens = identity_matrix()
        lens[3, :] = perspective[:4]
        made = lens @ made
    whole: Array = made / made[3, 3]
    return whole


def decompose_matrix(matrix: Any) -> tuple[Array, Array, tuple[float, float, float], Array, Array]:
    """Scale, shear, Euler angles, translation and perspective of a matrix."""
    translation, rotation, scale, shear = affines.decompose(np.asarray(matrix))
    return scale, shear, euler_from_matrix(rotation), translation, np.asarray(matrix, dtype=np.float64)[3, :]


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Array:
    """The rotation by three Euler angles."""
    return _affine(euler.euler2mat(ai, aj, ak, axes=axes))


def euler_from_matrix(matrix: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """The Euler angles of a rotation, of 3 by 3 or 4 by 4 numbers."""
    roll, pitch, yaw = euler.mat2euler(np.asarray(matrix)[:3, :3], axes=axes)
    return roll, pitch, yaw


def euler_from_quaternion(quaternion: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """The Euler angles of a quaternion: roll, pitch and yaw."""
    roll, pitch, yaw = euler.quat2euler(_w_first(quaternion), axes=axes)
    return roll, pitch, yaw


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Array:
    """The quaternion of three Euler angles: roll, pitch and yaw."""
    return _w_last(euler.euler2quat(ai, aj, ak, axes=axes))


def quaternion_about_axis(angle: float, axis: Any) -> Array:
    """The quaternion of a rotation by an angle about an axis."""
    return _w_last(quaternions.axangle2quat(axis[:3], angle))


def quaternion_matrix(quaternion: Any) -> Array:
    """The rotation matrix of a quaternion."""
    return _affine(quaternions.quat2mat(_w_first(quaternion)))


def quaternion_from_matrix(matrix: Any) -> Array:
    """The quaternion of a rotation matrix."""
    return _w_last(quaternions.mat2quat(np.asarray(matrix)[:3, :3]))


def quaternion_multiply(quaternion1: Any, quaternion0: Any) -> Array:
    """The product of two quaternions: the second is applied first."""
    return _w_last(quaternions.qmult(_w_first(quaternion1), _w_first(quaternion0)))


def quaternion_conjugate(quaternion: Any) -> Array:
    """The conjugate of a quaternion."""
    return _w_last(quaternions.qconjugate(_w_first(quaternion)))


def quaternion_inverse(quaternion: Any) -> Array:
    """The inverse of a quaternion."""
    return _w_last(quaternions.qinverse(_w_first(quaternion)))


def quaternion_slerp(
    quat0: Any, quat1: Any, fraction: float, spin: int = 0, shortestpath: bool = True
) -> Array:
    """The quaternion at a fraction of the way between two, with ``spin`` more turns."""
    first, second = (unit_vector(_w_first(each)) for each in (quat0, quat1))
    if fraction in {0.0, 1.0}:
        return _w_last(second if fraction else first)
    cosine = float(first @ second)
    if shortestpath and cosine < 0.0:
        cosine, second = -cosine, -second
    angle = math.acos(min(max(cosine, -1.0), 1.0)) + spin * math.pi
    if abs(angle) < 4 * np.finfo(float).eps:
        return _w_last(first)
    share = (math.sin((1.0 - fraction) * angle), math.sin(fraction * angle))
    return _w_last((share[0] * first + share[1] * second) / math.sin(angle))


def random_quaternion(rand: Any = None) -> Array:
    """A uniformly random rotation, from three numbers between 0 and 1 if they are given."""
    r = np.random.rand(3) if rand is None else np.asarray(rand)
    inner, outer = math.sqrt(1.0 - r[0]), math.sqrt(r[0])
    first, second = 2 * math.pi * r[1], 2 * math.pi * r[2]
    return np.array(
        (math.sin(first) * inner, math.cos(first) * inner, math.sin(second) * outer, math.cos(second) * outer)
    )


def random_rotation_matrix(rand: Any = None) -> Array:
    """A uniformly random rotation matrix; ``rand`` as for `random_quaternion`."""
    return quaternion_matrix(random_quaternion(rand))


def random_vector(size: int) -> Array:
    """Random numbers between 0 and 1."""
    return np.random.random(size)


def vector_norm(data: Any, axis: int | None = None, out: Any = None) -> Any:
    """The length of a vector, or of the vectors along an axis; written to ``out`` if given."""
    lengths = np.linalg.norm(np.asarray(data, dtype=np.float64), axis=axis)
    if out is None:
        return lengths
    out[...] = lengths
    return None


def unit_vector(data: Any, axis: int | None = None, out: Any = None) -> Any:
    """A vector, or the vectors along an axis, scaled to length 1; written to ``out`` if given."""
    data = np.array(data, dtype=np.float64)
    lengths = np.linalg.norm(data, axis=axis, keepdims=axis is not None)
    if out is None:
        return data / lengths
    out[...] = data / lengths
    return None

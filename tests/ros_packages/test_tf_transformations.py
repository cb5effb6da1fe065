"""tf_transformations: quaternions with w last, by transforms3d."""

import math

import numpy as np
import pytest

from sim.ros_packages import tf_transformations as tft

HALF = math.sqrt(0.5)


def test_a_quarter_turn_is_what_messages_hold() -> None:
    assert np.allclose(tft.quaternion_from_euler(0, 0, math.pi / 2), (0, 0, HALF, HALF))
    assert np.allclose(tft.euler_from_quaternion((0, 0, HALF, HALF)), (0, 0, math.pi / 2))
    assert np.allclose(tft.quaternion_about_axis(math.pi / 2, (0, 0, 1)), (0, 0, HALF, HALF))
    assert np.allclose(
        tft.quaternion_from_matrix(tft.rotation_matrix(math.pi / 2, (0, 0, 1))), (0, 0, HALF, HALF)
    )


@pytest.mark.parametrize("axes", ["sxyz", "rzyx", "szxz"])
def test_euler_angles_come_back_in_any_order_of_axes(axes: str) -> None:
    angles = (0.3, 0.5, -0.7)
    assert np.allclose(tft.euler_from_quaternion(tft.quaternion_from_euler(*angles, axes), axes), angles)
    assert np.allclose(tft.euler_from_matrix(tft.euler_matrix(*angles, axes), axes), angles)


def test_the_second_of_a_product_is_applied_first() -> None:
    roll = tft.quaternion_from_euler(math.pi / 2, 0, 0)
    yaw = tft.quaternion_from_euler(0, 0, math.pi / 2)
    both = tft.quaternion_matrix(tft.quaternion_multiply(yaw, roll))
    assert np.allclose(
        both, tft.concatenate_matrices(tft.quaternion_matrix(yaw), tft.quaternion_matrix(roll))
    )
    assert np.allclose(both @ (0, 1, 0, 1), (0, 0, 1, 1))
    assert np.allclose(tft.quaternion_multiply(roll, tft.quaternion_inverse(roll)), (0, 0, 0, 1))


def test_half_way_between_two_quaternions_is_the_shorter_way() -> None:
    start, end = tft.quaternion_from_euler(0, 0, 0), tft.quaternion_from_euler(0, 0, 1.0)
    half = tft.quaternion_from_euler(0, 0, 0.5)
    assert np.allclose(tft.quaternion_slerp(start, end, 0.5), half)
    assert np.allclose(tft.quaternion_slerp(start, -end, 0.5), half)
    assert np.allclose(tft.quaternion_slerp(start, end, 1.0), end)


def test_matrices_are_composed_and_taken_apart() -> None:
    made = tft.compose_matrix(scale=(1, 2, 3), angles=(0.1, 0.2, 0.3), translate=(4, 5, 6))
    scale, shear, angles, moved, perspective = tft.decompose_matrix(made)
    assert np.allclose((*scale, *shear, *angles, *moved), (1, 2, 3, 0, 0, 0, 0.1, 0.2, 0.3, 4, 5, 6))
    assert np.allclose(perspective, (0, 0, 0, 1))
    assert tft.is_same_transform(made @ tft.inverse_matrix(made), tft.identity_matrix())
    assert tft.translation_from_matrix(tft.translation_matrix((1, 2, 3))).tolist() == [1, 2, 3]


def test_what_a_matrix_does_is_read_off_it() -> None:
    angle, axis, _ = tft.rotation_from_matrix(tft.rotation_matrix(0.4, (0, 1, 0), (1, 0, 0)))
    assert np.allclose((angle * axis[1]), 0.4)
    point, normal = tft.reflection_from_matrix(tft.reflection_matrix((0, 0, 2), (0, 0, 1)))
    assert tft.is_same_transform(
        tft.reflection_matrix(point, normal), tft.reflection_matrix((0, 0, 2), (0, 0, 1))
    )
    assert tft.scale_from_matrix(tft.scale_matrix(-1.5))[0] == pytest.approx(-1.5)
    sheared = tft.shear_matrix(0.3, (1, 0, 0), (0, 0, 1), (0, 0, 1))
    assert tft.is_same_transform(tft.shear_matrix(*tft.shear_from_matrix(sheared)), sheared)


def test_lengths_and_random_rotations() -> None:
    assert tft.vector_norm((3, 4)) == 5
    assert tft.unit_vector((0, 0, 2)).tolist() == [0, 0, 1]
    assert tft.vector_norm(tft.random_quaternion((0.1, 0.2, 0.3))) == pytest.approx(1)
    assert np.allclose(np.linalg.det(tft.random_rotation_matrix()[:3, :3]), 1)
    assert tft.random_vector(4).shape == (4,)

"""``tf2_geometry_msgs.tf2_geometry_msgs``: transforms points, vectors and poses."""

from typing import Any

import numpy as np
from geometry_msgs.msg import (
    Point32,
    PointStamped,
    PolygonStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Vector3Stamped,
)
from transforms3d.quaternions import quat2mat

from sim.ros_packages.tf2_py.motion import Motion
from sim.ros_packages.tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

__all__ = [
    "do_transform_point",
    "do_transform_polygon_stamped",
    "do_transform_pose",
    "do_transform_pose_stamped",
    "do_transform_pose_with_covariance_stamped",
    "do_transform_vector3",
    "from_msg_msg",
    "to_msg_msg",
    "transform_covariance",
]


def to_msg_msg(msg: Any) -> Any:
    """A message, as the message that it is."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """A message, as the message that it is."""
    return msg


def _motion(transform: Any) -> Motion:
    return Motion.of(transform.transform.translation, transform.transform.rotation)


def _numbers(point: Any) -> Any:
    return np.array((point.x, point.y, point.z))


def do_transform_point(point: Any, transform: Any) -> Any:
    """Transform a ``PointStamped``; the result has the transform's frame and time."""
    made = PointStamped(header=transform.header)
    made.point.x, made.point.y, made.point.z = map(float, _motion(transform)(_numbers(point.point)))
    return made


def do_transform_polygon_stamped(polygon: Any, transform: Any) -> Any:
    """Transform a ``PolygonStamped``; the result has the transform's frame and time."""
    made, motion = PolygonStamped(header=transform.header), _motion(transform)
    moved = (map(float, motion(_numbers(point))) for point in polygon.polygon.points)
    made.polygon.points = [Point32(x=x, y=y, z=z) for x, y, z in moved]
    return made


def do_transform_vector3(vector3: Any, transform: Any) -> Any:
    """Rotate a ``Vector3Stamped``, without translation; the result has the transform's frame and time."""
    made = Vector3Stamped(header=transform.header)
    made.vector.x, made.vector.y, made.vector.z = map(
        float, _motion(transform).turned(_numbers(vector3.vector))
    )
    return made


def do_transform_pose(pose: Any, transform: Any) -> Any:
    """Transform a ``Pose`` to the transform's frame."""
    made = Pose()
    moved = _motion(transform).after(Motion.of(pose.position, pose.orientation))
    moved.write(made.position, made.orientation)
    return made


def do_transform_pose_stamped(pose: Any, transform: Any) -> Any:
    """Transform a ``PoseStamped``; the result has the transform's frame and time."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def transform_covariance(cov_in: Any, transform: Any) -> Any:
    """Rotate a covariance of 6 by 6 numbers, position before rotation, to the transform's frame."""
    turn = quat2mat(_motion(transform).rotation)
    both = np.kron(np.eye(2), turn)
    return (both @ np.reshape(cov_in, (6, 6)) @ both.T).reshape(36)


def do_transform_pose_with_covariance_stamped(pose: Any, transform: Any) -> Any:
    """Transform a ``PoseWithCovarianceStamped``; the result has the transform's frame and time."""
    made = PoseWithCovarianceStamped(header=transform.header)
    made.pose.pose = do_transform_pose(pose.pose.pose, transform)
    made.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return made


for _type, _do_transform in (
    (PointStamped, do_transform_point),
    (Vector3Stamped, do_transform_vector3),
    (PoseStamped, do_transform_pose_stamped),
    (PolygonStamped, do_transform_polygon_stamped),
    (PoseWithCovarianceStamped, do_transform_pose_with_covariance_stamped),
):
    TransformRegistration().add(_type, _do_transform)
    ConvertRegistration().add_to_msg(_type, to_msg_msg)
    ConvertRegistration().add_from_msg(_type, from_msg_msg)

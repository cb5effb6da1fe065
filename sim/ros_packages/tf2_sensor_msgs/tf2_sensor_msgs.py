"""``tf2_sensor_msgs.tf2_sensor_msgs``: transforms point clouds."""

from copy import deepcopy
from typing import Any

import numpy as np
from sensor_msgs.msg import PointCloud2
from sensor_msgs_py.point_cloud2 import create_cloud, read_points
from transforms3d.quaternions import quat2mat

from sim.ros_packages.tf2_py.motion import Motion
from sim.ros_packages.tf2_ros.buffer_interface import ConvertRegistration, TransformRegistration

__all__ = ["do_transform_cloud", "transform_points"]


def transform_points(point_cloud: Any, transform: Any) -> Any:
    """Apply a ``Transform`` to an array of points with three numbers per row."""
    motion = Motion.of(transform.translation, transform.rotation)
    return point_cloud @ quat2mat(motion.rotation).T + motion.translation


def do_transform_cloud(cloud: Any, transform: Any) -> Any:
    """Transform a ``PointCloud2``; fields other than x, y and z stay. The result has the transform's header.

    Raises:
        AssertionError: the cloud has no fields x, y and z.
    """
    points = read_points(cloud).copy()
    assert {"x", "y", "z"} <= set(points.dtype.names), "the cloud has no fields x, y and z"
    before = np.stack([points[axis] for axis in "xyz"], axis=-1)
    for axis, values in zip("xyz", transform_points(before, transform.transform).T, strict=True):
        points[axis] = values
    made = create_cloud(transform.header, cloud.fields, points, cloud.point_step)
    made.height, made.width, made.row_step = cloud.height, cloud.width, cloud.row_step
    made.is_dense = cloud.is_dense
    return made


TransformRegistration().add(PointCloud2, do_transform_cloud)
ConvertRegistration().add_to_msg(PointCloud2, deepcopy)
ConvertRegistration().add_from_msg(PointCloud2, deepcopy)

"""``sensor_msgs_py.point_cloud2``: clouds made of points, and read back."""

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

from sim.interfaces import message
from sim.interfaces.sensor_msgs_py import point_cloud2

PointField: Any = message("sensor_msgs", "PointField")
Header: Any = message("std_msgs", "Header")

MIXED = [
    PointField(name="x", offset=0, datatype=PointField.FLOAT32, count=1),
    PointField(name="ring", offset=4, datatype=PointField.UINT16, count=1),
]


def test_a_cloud_of_x_y_z_is_read_as_it_was_written() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="map"), [(1, 2, 3), (4, 5, 6.5)])
    assert (cloud.width, cloud.height, cloud.point_step, cloud.row_step) == (2, 1, 12, 24)
    assert [field.name for field in cloud.fields] == ["x", "y", "z"]
    assert cloud.header.frame_id == "map"
    assert point_cloud2.read_points_numpy(cloud).tolist() == [[1, 2, 3], [4, 5, 6.5]]
    assert point_cloud2.read_points_numpy(cloud, field_names=["z"]).tolist() == [[3], [6.5]]


def test_fields_of_several_types_are_read_as_a_structured_array() -> None:
    cloud = point_cloud2.create_cloud(Header(), MIXED, [(0.5, 7), (1.5, 8)], point_step=8)
    assert cloud.point_step == 8
    points = point_cloud2.read_points(cloud)
    assert points["x"].tolist() == [0.5, 1.5]
    assert points["ring"].tolist() == [7, 8]
    last: Any = point_cloud2.read_points_list(cloud)[1]
    assert last.ring == 8
    with pytest.raises(AssertionError, match="same datatype"):
        point_cloud2.read_points_numpy(cloud)


def test_points_with_a_nan_are_left_out_when_asked() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(), np.array([[1, 2, 3], [4, np.nan, 6]]))
    assert len(point_cloud2.read_points(cloud)) == 2
    assert point_cloud2.read_points(cloud, skip_nans=True).tolist() == [(1, 2, 3)]


def test_an_array_of_rows_makes_an_organised_cloud() -> None:
    grid = np.arange(18, dtype=np.float32).reshape(2, 3, 3)
    cloud = point_cloud2.create_cloud_xyz32(Header(), grid)
    assert (cloud.height, cloud.width) == (2, 3)
    assert point_cloud2.read_points_numpy(cloud, uvs=[(1, 1)]).tolist() == grid[1, 1:2].tolist()
    assert point_cloud2.read_points(cloud, reshape_organized_cloud=True).shape == (3, 2)


def test_a_field_that_the_cloud_does_not_have_is_refused() -> None:
    cloud = point_cloud2.create_cloud_xyz32(Header(), [(1, 2, 3)])
    with pytest.raises(AssertionError, match="not in the fields"):
        point_cloud2.read_points(cloud, field_names=["intensity"])


def test_it_is_imported_as_on_a_ros_machine_and_only_then_loaded() -> None:
    program = (
        "from sim.ros import importing\n"
        "importing.install()\n"
        "import sys\n"
        "assert 'sim.interfaces.sensor_msgs_py.point_cloud2' not in sys.modules\n"
        "import sensor_msgs_py.point_cloud2 as pc2\n"
        "from sensor_msgs_py import point_cloud2\n"
        "assert pc2 is point_cloud2 is sys.modules['sim.interfaces.sensor_msgs_py.point_cloud2']\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)

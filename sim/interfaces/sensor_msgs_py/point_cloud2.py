"""``sensor_msgs_py.point_cloud2``: point clouds as numpy arrays, and numpy arrays as point clouds."""

import array
import sys
from collections import namedtuple
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from sim.interfaces import message

__all__ = [
    "DUMMY_FIELD_PREFIX",
    "create_cloud",
    "create_cloud_xyz32",
    "dtype_from_fields",
    "read_points",
    "read_points_list",
    "read_points_numpy",
]

DUMMY_FIELD_PREFIX = "unnamed_field"
"""The prefix of the name of an unnamed field; its number follows."""

_PointField: Any = message("sensor_msgs", "PointField")
_PointCloud2: Any = message("sensor_msgs", "PointCloud2")

_DATATYPES: dict[int, np.dtype[Any]] = {
    _PointField.INT8: np.dtype(np.int8),
    _PointField.UINT8: np.dtype(np.uint8),
    _PointField.INT16: np.dtype(np.int16),
    _PointField.UINT16: np.dtype(np.uint16),
    _PointField.INT32: np.dtype(np.int32),
    _PointField.UINT32: np.dtype(np.uint32),
    _PointField.FLOAT32: np.dtype(np.float32),
    _PointField.FLOAT64: np.dtype(np.float64),
}


def read_points(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> npt.NDArray[Any]:
    """Read the points of a ``PointCloud2`` into a structured array with one element per point.

    ``field_names`` are the fields to keep (None: all); ``skip_nans`` drops points with a NaN;
    ``uvs`` are the indices of the points to keep, numbers or (for an organised cloud) ``(u, v)`` pairs;
    ``reshape_organized_cloud`` gives an organised cloud its two dimensions, ``width`` by ``height``.

    Raises:
        AssertionError: ``cloud`` is not a PointCloud2, or lacks one of the fields.
    """
    assert isinstance(cloud, _PointCloud2), "Cloud is not a sensor_msgs.msg.PointCloud2"
    layout = dtype_from_fields(cloud.fields, point_step=cloud.point_step)
    points: npt.NDArray[Any] = np.ndarray(
        shape=(cloud.width * cloud.height,), dtype=layout, buffer=bytes(cloud.data)
    )
    if field_names is not None:
        known = points.dtype.names or ()
        assert all(name in known for name in field_names), "Requests field is not in the fields!"
        points = points[list(field_names)]
    if bool(sys.byteorder != "little") != bool(cloud.is_bigendian):
        points = points.byteswap()
    if skip_nans and not cloud.is_dense:
        points = points[_without_nans(points)]
    if uvs is not None:
        points = points[_indices(uvs, cloud)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.width, cloud.height)
    return points


def _without_nans(points: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    kept = np.ones(len(points), dtype=bool)
    for name in points.dtype.names or ():
        values = points[name]
        if np.issubdtype(values.dtype, np.floating):
            kept &= ~np.isnan(values.reshape(len(points), -1)).any(axis=1)
    return kept


def _indices(uvs: Iterable[Any], cloud: Any) -> npt.NDArray[Any]:
    chosen = uvs if isinstance(uvs, np.ndarray) else np.array(list(uvs))
    if chosen.ndim == 2:
        chosen = chosen[:, 1] * cloud.width + chosen[:, 0]
    return chosen


def read_points_numpy(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> npt.NDArray[Any]:
    """Read the points into a plain array, with a row per point and a column per field; see ``read_points``.

    Raises:
        AssertionError: the chosen fields are not all of one type.
    """
    assert all(cloud.fields[0].datatype == field.datatype for field in cloud.fields[1:]) or field_names, (
        "All fields need to have the same datatype. Use `read_points()` otherwise."
    )
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    kinds = {points.dtype[name].base for name in points.dtype.names or ()}
    assert len(kinds) == 1, "All fields need to have the same datatype. Use `read_points()` otherwise."
    columns = [np.asarray(points[name]).reshape(*points.shape, -1) for name in points.dtype.names or ()]
    return np.concatenate(columns, axis=-1)


def read_points_list(
    cloud: Any,
    field_names: list[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
) -> list[NamedTuple]:
    """Read the points into a list of named tuples; see ``read_points``."""
    names = [field.name for field in cloud.fields] if field_names is None else field_names
    point: Any = namedtuple("Point", names)  # type: ignore[misc]
    return [point._make(each) for each in read_points(cloud, field_names, skip_nans, uvs)]


def dtype_from_fields(fields: Iterable[Any], point_step: int | None = None) -> np.dtype[Any]:
    """The dtype of a point of ``point_step`` bytes with the given ``PointField`` messages."""
    names, offsets, formats = [], [], []
    for number, field in enumerate(fields):
        names.append(field.name or f"{DUMMY_FIELD_PREFIX}_{number}")
        offsets.append(field.offset)
        kind = _DATATYPES[field.datatype]
        formats.append(kind if field.count <= 1 else np.dtype((kind, (field.count,))))
    layout: Any = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        layout["itemsize"] = point_step
    made: np.dtype[Any] = np.dtype(layout)
    return made


def create_cloud(
    header: Any,
    fields: Iterable[Any],
    points: Iterable[Any],
    step: int | None = None,
    point_step: int | None = None,
) -> Any:
    """Make a ``PointCloud2`` from a structured array, or from rows with a value for each field.

    A two-dimensional array of points makes an organised cloud of height by width.

    Raises:
        AssertionError: the points have other types than the fields, or another number of values.
    """
    fields = list(fields)
    points = points if isinstance(points, np.ndarray) else _as_array(points, fields, point_step or step)
    layout = dtype_from_fields(fields, point_step=point_step or step)
    if points.dtype.names is None:
        assert points.shape[-1] == len(fields), "The points have another number of values than fields"
        points = _as_structured(points, layout)
    else:
        assert points.dtype == layout, (
            "PointFields and structured NumPy array dtype do not match for all fields! "
            "Check their field order, names and types."
        )
    assert points.ndim <= 2, "Too many dimensions: points are rows, or a grid of them"
    height, width = (1, points.shape[0]) if points.ndim == 1 else points.shape
    data = array.array("B")
    data.frombytes(np.ascontiguousarray(points).tobytes())
    return _PointCloud2(
        header=header,
        height=height,
        width=width,
        is_dense=False,
        is_bigendian=sys.byteorder != "little",
        fields=fields,
        point_step=points.dtype.itemsize,
        row_step=points.dtype.itemsize * width,
        data=data,
    )


def _as_array(points: Iterable[Any], fields: Sequence[Any], step: int | None) -> npt.NDArray[Any]:
    layout = dtype_from_fields(fields, point_step=step)
    return np.array([tuple(point) for point in points], dtype=layout)


def _as_structured(points: npt.NDArray[Any], layout: np.dtype[Any]) -> npt.NDArray[Any]:
    structured = np.zeros(points.shape[:-1], dtype=layout)
    for column, name in enumerate(layout.names or ()):
        structured[name] = points[..., column]
    return structured


def create_cloud_xyz32(header: Any, points: Iterable[Any], step: int | None = None) -> Any:
    """Make a ``PointCloud2`` with the float32 fields x, y and z; see ``create_cloud``."""
    fields = [
        _PointField(name=name, offset=4 * place, datatype=7, count=1) for place, name in enumerate("xyz")
    ]
    return create_cloud(header, fields, points, step)

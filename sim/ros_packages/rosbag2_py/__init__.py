"""``rosbag2_py``: bags of messages, read and written by way of rosbags."""

from sim.ros_packages.rosbag2_py._info import Info
from sim.ros_packages.rosbag2_py._reader import SequentialReader
from sim.ros_packages.rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    StorageFilter,
    StorageOptions,
    TopicInformation,
    TopicMetadata,
)
from sim.ros_packages.rosbag2_py._writer import SequentialWriter


def get_registered_readers() -> set[str]:
    """The storages that bags are read from."""
    return {"mcap", "sqlite3"}


def get_registered_writers() -> set[str]:
    """The storages that bags are written to."""
    return {"mcap", "sqlite3"}

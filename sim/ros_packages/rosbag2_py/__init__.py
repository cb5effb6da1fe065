"""``rosbag2_py``: bags of messages, read and written by rosbags."""

from sim.ros_packages.rosbag2_py._info import Info
from sim.ros_packages.rosbag2_py._reader import SequentialCompressionReader, SequentialReader
from sim.ros_packages.rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    MessageDefinition,
    ReadOrder,
    ReadOrderSortBy,
    StorageFilter,
    StorageOptions,
    TopicInformation,
    TopicMetadata,
    get_default_storage_id,
)
from sim.ros_packages.rosbag2_py._writer import SequentialWriter


def get_registered_readers() -> set[str]:
    """The storages that can be read."""
    return {"mcap", "sqlite3"}


def get_registered_writers() -> set[str]:
    """The storages that can be written."""
    return {"mcap", "sqlite3"}


def get_registered_compressors() -> set[str]:
    """The compressions that can be read."""
    return {"zstd"}


def get_registered_serializers() -> set[str]:
    """The serializations of messages."""
    return {"cdr"}

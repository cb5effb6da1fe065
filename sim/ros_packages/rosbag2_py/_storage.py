"""``rosbag2_py._storage``: options and metadata of bags."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from typing import Any


@dataclass
class StorageOptions:
    """A bag: its path (of a file, or a folder with ``metadata.yaml``), and ``mcap`` or ``sqlite3``."""

    uri: str
    storage_id: str = ""
    max_bagfile_size: int = 0
    max_bagfile_duration: int = 0
    max_cache_size: int = 0
    storage_preset_profile: str = ""
    storage_config_uri: str = ""
    snapshot_mode: bool = False
    start_time_ns: int = -1
    end_time_ns: int = -1
    custom_data: dict[str, str] = field(default_factory=dict)


@dataclass
class ConverterOptions:
    """The encoding of messages; it is always ``cdr``."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageFilter:
    """The topics to read; none: all topics."""

    topics: Sequence[str] = ()


class ReadOrderSortBy(Enum):
    """The key by which messages are sorted."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """The order in which messages are read."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass
class MessageDefinition:
    """The definition of a type, in the notation ``ros2msg`` or ``ros2idl``."""

    topic_type: str
    encoding: str
    encoded_message_definition: str
    type_hash: str


@dataclass
class TopicMetadata:
    """A topic of a bag."""

    id: int
    name: str
    type: str
    serialization_format: str
    offered_qos_profiles: Sequence[Any] = ()
    type_description_hash: str = ""

    def equals(self, other: TopicMetadata) -> bool:
        """Whether both are equal."""
        return self == other


@dataclass
class TopicInformation:
    """A topic of a bag, and its number of messages."""

    topic_metadata: TopicMetadata
    message_count: int


@dataclass
class BagMetadata:
    """The metadata of a bag. ``duration`` and ``starting_time`` are rclpy's ``Duration`` and ``Time``."""

    storage_identifier: str
    duration: Any
    starting_time: Any
    message_count: int
    topics_with_message_count: Sequence[TopicInformation]
    compression_format: str = ""
    compression_mode: str = ""
    ros_distro: str = ""


def get_default_storage_id() -> str:
    """The storage of new bags if none is given."""
    return "mcap"

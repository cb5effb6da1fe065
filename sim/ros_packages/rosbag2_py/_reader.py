"""``rosbag2_py._reader``: reads bags of ROS 2, and recordings of runs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rclpy.duration import Duration
from rclpy.time import Time

from sim.ros_packages.rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    MessageDefinition,
    ReadOrder,
    StorageFilter,
    StorageOptions,
    TopicInformation,
    TopicMetadata,
)

if TYPE_CHECKING:
    # At run time this import takes as long as the rest of a small program.
    from rosbags.rosbag2 import Reader

_PLUGINS = {"mcap": ".mcap", "sqlite3": ".db3"}


class SequentialReader:
    """Reads the messages of a bag one after another, in the order of their times."""

    def __init__(self) -> None:
        self._bag: Reader | None = None
        self._topics: frozenset[str] = frozenset()
        self._start: int | None = None
        self._messages: Iterator[tuple[str, bytes, int]] = iter(())
        self._next: tuple[str, bytes, int] | None = None

    def open(
        self, storage_options: StorageOptions, converter_options: ConverterOptions | None = None
    ) -> None:
        """Open a bag.

        Raises:
            RuntimeError: there is no such bag, or it cannot be read; the message says why.
        """
        from rosbags.rosbag2 import Reader, ReaderError

        path = Path(storage_options.uri)
        suffix = _PLUGINS.get(storage_options.storage_id or "mcap")
        if suffix is None or not path.exists():
            reason = (
                f"there is no storage {storage_options.storage_id!r}"
                if suffix is None
                else "it does not exist"
            )
            raise RuntimeError(f"No storage could be initialized from the inputs: {path}: {reason}.")
        try:
            self._bag = Reader(path)
            self._bag.open()
        except (ReaderError, OSError) as error:
            raise RuntimeError(f"No storage could be initialized from the inputs: {error}") from None
        self._rewind()

    def open_uri(self, uri: str) -> None:
        """Open a bag by its path. Raises as `open`."""
        self.open(StorageOptions(uri))

    def close(self) -> None:
        """Close the bag."""
        if self._bag is not None:
            self._bag.close()
        self._bag, self._next = None, None

    def has_next(self) -> bool:
        """Whether there is one more message."""
        return self._next is not None

    def read_next(self) -> tuple[str, bytes, int]:
        """The next message: topic, serialized message, and nanoseconds since 1970.

        Raises:
            RuntimeError: there is no further message.
        """
        if self._next is None:
            raise RuntimeError("Bag is at end. No next message.")
        read, self._next = self._next, next(self._messages, None)
        return read

    def seek(self, timestamp: int) -> None:
        """Continue with the first message at or after a time."""
        self._start = timestamp
        self._rewind()

    def set_filter(self, storage_filter: StorageFilter) -> None:
        """Skip all topics but those of the filter, from the current position on."""
        self._topics = frozenset(storage_filter.topics)
        self._go_on()

    def reset_filter(self) -> None:
        """Read all topics again."""
        self._topics = frozenset()
        self._go_on()

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """The topics of the bag."""
        return [each.topic_metadata for each in self.get_metadata().topics_with_message_count]

    def get_all_message_definitions(self) -> list[MessageDefinition]:
        """The definitions of the types of the bag's topics."""
        return [
            MessageDefinition(
                each.msgtype, f"ros2{each.msgdef.format.name.lower()}", each.msgdef.data, each.digest
            )
            for each in self._opened().connections
        ]

    def set_read_order(self, read_order: ReadOrder) -> bool:
        """Whether messages are read in that order; only the order of reception is supported."""
        return read_order == ReadOrder()

    def get_metadata(self) -> BagMetadata:
        """The metadata of the bag."""
        bag = self._opened()
        topics = [
            TopicInformation(
                TopicMetadata(each.id, each.topic, each.msgtype, "cdr", type_description_hash=each.digest),
                each.msgcount,
            )
            for each in bag.connections
        ]
        path = Path(str(bag.path))
        is_sqlite = path.suffix == _PLUGINS["sqlite3"] or any(path.glob("*.db3"))
        return BagMetadata(
            storage_identifier="sqlite3" if is_sqlite else "mcap",
            duration=Duration(nanoseconds=max(bag.duration, 0)),
            starting_time=Time(nanoseconds=bag.start_time if bag.message_count else 0),
            message_count=bag.message_count,
            topics_with_message_count=topics,
            compression_format=bag.compression_format or "",
            compression_mode=bag.compression_mode or "",
            ros_distro=bag.ros_distro or "",
        )

    def _go_on(self) -> None:
        if self._next is not None:
            self.seek(self._next[2])

    def _rewind(self) -> None:
        bag = self._opened()
        wanted = [each for each in bag.connections if not self._topics or each.topic in self._topics]
        found = bag.messages(wanted, start=self._start) if wanted else iter(())
        self._messages = ((each.topic, bytes(data), time) for each, time, data in found)
        self._next = next(self._messages, None)

    def _opened(self) -> Reader:
        if self._bag is None:
            raise RuntimeError("Bag is not open. Call open() before reading.")
        return self._bag


class SequentialCompressionReader(SequentialReader):
    """Reads compressed bags, which `SequentialReader` can read, too."""

"""``rosbag2_py._writer``: writes bags that ROS 2 reads."""

from __future__ import annotations

import atexit
import weakref
from pathlib import Path
from typing import TYPE_CHECKING

from sim.interfaces import definition, message_of_type
from sim.ros.middleware.type_description import type_hash
from sim.ros_packages.rosbag2_py._storage import ConverterOptions, StorageOptions, TopicMetadata

if TYPE_CHECKING:
    # At run time this import takes as long as the rest of a small program.
    from rosbags.interfaces import Connection
    from rosbags.rosbag2 import Writer


class SequentialWriter:
    """Writes messages to a new bag. Closing completes the bag, at the program's end at the latest."""

    def __init__(self) -> None:
        self._bag: Writer | None = None
        self._connections: dict[str, Connection] = {}

    def open(
        self, storage_options: StorageOptions, converter_options: ConverterOptions | None = None
    ) -> None:
        """Create the bag's folder.

        Raises:
            RuntimeError: the folder exists or cannot be created, or there is no such storage.
        """
        from rosbags.rosbag2 import StoragePlugin, Writer, WriterError

        plugins = {"": StoragePlugin.MCAP, "mcap": StoragePlugin.MCAP, "sqlite3": StoragePlugin.SQLITE3}
        path = Path(storage_options.uri)
        plugin = plugins.get(storage_options.storage_id)
        if plugin is None:
            raise RuntimeError(
                f"No storage could be initialized from the inputs: {path}: "
                f"there is no storage {storage_options.storage_id!r}."
            )
        if path.exists():
            raise RuntimeError(f"Bag directory already exists ({path}), can't overwrite existing bag")
        try:
            self._bag = Writer(path, version=9, storage_plugin=plugin)
            self._bag.open()
        except (WriterError, OSError) as error:
            raise RuntimeError(f"Failed to create bag directory ({path}): {error}") from None
        atexit.register(_close, weakref.ref(self))

    def create_topic(self, topic_with_type: TopicMetadata) -> None:
        """Add a topic, unless the bag has it.

        Raises:
            RuntimeError: the bag is not open.
            UnknownInterfaceError: the topic's type is unknown.
        """
        if topic_with_type.name in self._connections:
            return
        kind = message_of_type(topic_with_type.type)
        self._connections[topic_with_type.name] = self._opened().add_connection(
            topic_with_type.name, topic_with_type.type, msgdef=definition(kind), rihs01=str(type_hash(kind))
        )

    def write(self, topic_name: str, message: bytes, time_stamp: int) -> None:
        """Write a serialized message with its time in nanoseconds since 1970.

        Raises:
            RuntimeError: the bag is not open, or has no such topic.
        """
        bag = self._opened()
        connection = self._connections.get(topic_name)
        if connection is None:
            raise RuntimeError(f"Topic '{topic_name}' has not been created yet! Call 'create_topic' first.")
        bag.write(connection, time_stamp, message)

    def close(self) -> None:
        """Complete the bag, unless it is closed."""
        bag, self._bag = self._bag, None
        if bag is not None:
            bag.close()

    def __del__(self) -> None:
        self.close()

    def _opened(self) -> Writer:
        if self._bag is None:
            raise RuntimeError("Bag is not open. Call open() before writing.")
        return self._bag


def _close(writer: weakref.ref[SequentialWriter]) -> None:
    alive = writer()
    if alive is not None:
        alive.close()

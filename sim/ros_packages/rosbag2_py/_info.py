"""``rosbag2_py._info``: the metadata of bags."""

from sim.ros_packages.rosbag2_py._reader import SequentialReader
from sim.ros_packages.rosbag2_py._storage import BagMetadata, StorageOptions


class Info:
    """Reads the metadata of bags."""

    def read_metadata(self, uri: str, storage_id: str = "") -> BagMetadata:
        """The metadata of a bag; RuntimeError if it cannot be read."""
        reader = SequentialReader()
        reader.open(StorageOptions(uri, storage_id))
        found = reader.get_metadata()
        reader.close()
        return found

"""``rosbag2_py._info``: what a bag says of itself."""

from sim.ros_packages.rosbag2_py._reader import SequentialReader
from sim.ros_packages.rosbag2_py._storage import BagMetadata, StorageOptions


class Info:
    """Asks bags about themselves."""

    def read_metadata(self, uri: str, storage_id: str = "") -> BagMetadata:
        """What a bag says of itself; RuntimeError if it cannot be read."""
        reader = SequentialReader()
        reader.open(StorageOptions(uri, storage_id))
        found = reader.get_metadata()
        reader.close()
        return found

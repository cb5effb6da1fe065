"""ROS 2 packages as they lie in a workspace's sources, read without building or running anything."""

from sim.packages.errors import PackageError, UnknownExecutableError, UnknownPackageError
from sim.packages.finding import Packages, find_packages
from sim.packages.index import known_packages, use_packages
from sim.packages.package import Executable, Package
from sim.packages.setup_file import EntryPoint

__all__ = [
    "EntryPoint",
    "Executable",
    "Package",
    "PackageError",
    "Packages",
    "UnknownExecutableError",
    "UnknownPackageError",
    "find_packages",
    "known_packages",
    "use_packages",
]

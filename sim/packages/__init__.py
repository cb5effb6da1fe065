"""ROS 2 packages in a workspace's sources, read without building or running them."""

from sim.packages.errors import PackageError, UnknownPackageError
from sim.packages.finding import Packages, find_packages
from sim.packages.index import known_packages, use_packages
from sim.packages.package import Executable, Package

__all__ = [
    "Executable",
    "Package",
    "PackageError",
    "Packages",
    "UnknownPackageError",
    "find_packages",
    "known_packages",
    "use_packages",
]

"""The packages known to this process, as in the ament index of a ROS 2 machine."""

from sim.packages.finding import Packages

_known = Packages()


def use_packages(packages: Packages) -> None:
    """Set the known packages."""
    global _known  # noqa: PLW0603 -- a process has one index
    _known = packages


def known_packages() -> Packages:
    """Return the packages last given to ``use_packages``; none before that."""
    return _known

"""The packages that this process knows, as the ament index does on a ROS 2 machine."""

from sim.packages.finding import Packages

_known = Packages()


def use_packages(packages: Packages) -> None:
    """Have ``packages`` be those that are known from now on."""
    global _known  # noqa: PLW0603 -- a process has one index
    _known = packages


def known_packages() -> Packages:
    """The packages last given to ``use_packages``; none before that."""
    return _known

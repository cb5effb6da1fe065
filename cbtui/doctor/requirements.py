"""The dependencies in the metadata of the installed cbtui."""

from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, requires

from packaging.requirements import Requirement

PHYSICS = frozenset({"pybullet", "pybullet-arm64"})
"""Packages with the module ``pybullet``, of which a machine has one or none."""


@cache
def requirements(extra: str = "") -> Sequence[Requirement]:
    """Return the dependencies for this Python, with those of one extra; none if cbtui is not installed."""
    try:
        lines = requires("cbtui") or []
    except PackageNotFoundError:
        return ()
    found = map(Requirement, lines)
    return tuple(each for each in found if each.marker is None or each.marker.evaluate({"extra": extra}))

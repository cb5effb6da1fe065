"""Selects parameters by prefixes and depth."""

from collections.abc import Iterable

from sim.ros.parameters.parameter import PARAMETER_SEPARATOR_STRING


def listed(names: Iterable[str], prefixes: list[str], depth: int) -> tuple[list[str], list[str]]:
    """The names with the prefixes (none: all), at most ``depth`` levels deep (0: any), and their parents.

    Raises:
        TypeError, ValueError: the prefixes are not a list of str, or the depth is not an int of at least 0.
    """
    if not isinstance(prefixes, list):
        raise TypeError("The prefixes argument must be a list")
    if not all(isinstance(prefix, str) for prefix in prefixes):
        raise TypeError("All prefixes must be instances of type str")
    if not isinstance(depth, int):
        raise TypeError("The depth must be an integer")
    if depth < 0:
        raise ValueError("The depth must be greater than or equal to zero")
    found = [name for name in tuple(names) if _is_listed(name, prefixes, depth)]
    above = (name.rpartition(PARAMETER_SEPARATOR_STRING)[0] for name in found)
    return found, [prefix for prefix in dict.fromkeys(above) if prefix]


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    if not prefixes:
        return _within(name, depth)
    return any(
        name == prefix
        or (
            name.startswith(prefix + PARAMETER_SEPARATOR_STRING)
            and _within(name.removeprefix(prefix + PARAMETER_SEPARATOR_STRING), depth)
        )
        for prefix in prefixes
    )


def _within(name: str, depth: int) -> bool:
    return depth == 0 or name.count(PARAMETER_SEPARATOR_STRING) < depth

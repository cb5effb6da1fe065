"""The dependencies in the metadata of the installed cbtui, and version ranges."""

import re
import sys
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, requires
from itertools import takewhile
from typing import NamedTuple

_NAME = re.compile(r"[\w.-]+")
_BOUND = re.compile(r"(>=|<=|==|!=|<|>)\s*([\d.]+)")
_PYTHON = re.compile(r"""python_version\s*(<|>=)\s*['"]([\d.]+)['"]""")


class Requirement(NamedTuple):
    """A distribution name and its version range, such as ``>=8,<9``."""

    name: str
    versions: str


@cache
def requirements() -> Sequence[Requirement]:
    """Return the dependencies for this Python; none if cbtui is not installed."""
    try:
        lines = requires("cbtui") or []
    except PackageNotFoundError:
        return ()
    return tuple(needed for line in lines if (needed := read_requirement(line)) is not None)


def read_requirement(line: str, python: tuple[int, ...] = sys.version_info[:2]) -> Requirement | None:
    """Parse a requirement of the metadata; None if it is for an extra, or for other Pythons."""
    what, _, marker = line.partition(";")
    name = _NAME.match(what)
    if name is None or "extra" in marker:
        return None
    bound = _PYTHON.search(marker)
    if bound is not None and (python < _numbers(bound[2])) != (bound[1] == "<"):
        return None
    return Requirement(name[0], what[name.end() :].strip(" ()"))


def in_range(version: str, versions: str) -> bool:
    """Tell whether a version is in a range; only its leading numbers count."""
    found = _numbers("".join(takewhile(lambda sign: sign.isdigit() or sign == ".", version)))
    return all(_holds(found, sign, _numbers(bound)) for sign, bound in _BOUND.findall(versions))


def _holds(found: tuple[int, ...], sign: str, bound: tuple[int, ...]) -> bool:
    length = max(len(found), len(bound))
    left, right = (each + (0,) * (length - len(each)) for each in (found, bound))
    match sign:
        case ">=":
            return left >= right
        case "<=":
            return left <= right
        case "==":
            return left == right
        case "!=":
            return left != right
        case "<":
            return left < right
        case _:
            return left > right


def _numbers(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(".") if part)

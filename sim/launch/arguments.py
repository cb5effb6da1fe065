"""The arguments of a launch: those given as ``name:=value``, and those that a launch file declares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sim.launch.errors import LaunchError
from sim.launch.loading import load_description


@dataclass(frozen=True, slots=True)
class LaunchArgument:
    """An argument that a launch file declares; ``default`` None: one must be given."""

    name: str
    description: str
    default: str | None


def read_arguments(arguments: Sequence[str]) -> dict[str, str]:
    """Values by name; of two for one name the last counts.

    Raises:
        LaunchError: one is not of the form ``name:=value``.
    """
    found = {}
    for each in arguments:
        name, assigned, value = each.partition(":=")
        if not assigned or not name:
            raise LaunchError(f"malformed launch argument '{each}', expected format '<name>:=<value>'")
        found[name] = value
    return found


def launch_arguments(path: Path) -> list[LaunchArgument]:
    """The arguments that a launch file, and what it includes, declares; each name once.

    Raises:
        LaunchError: it cannot be read.
    """
    found: dict[str, LaunchArgument] = {}
    for each in load_description(path).get_launch_arguments():
        default = each.default_value
        text = None if default is None else " + ".join(part.describe() for part in default)
        found.setdefault(each.name, LaunchArgument(each.name, each.description, text))
    return list(found.values())


def describe_arguments(path: Path) -> str:
    """What ``ros2 launch FILE --show-args`` prints.

    Raises:
        LaunchError: it cannot be read.
    """
    lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
    for each in launch_arguments(path):
        lines += ["", f"    '{each.name}':", f"        {each.description}"]
        if each.default is not None:
            lines.append(f"        (default: {each.default})")
    if len(lines) == 1:
        lines += ["", "  No arguments."]
    return "\n".join(lines)

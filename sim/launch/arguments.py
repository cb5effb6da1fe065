"""The arguments of a launch: those given as ``name:=value``, and those that a launch file declares."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from sim.launch.errors import LaunchError
from sim.launch.loading import load_description

if TYPE_CHECKING:
    from sim.launch.launch.actions.arguments import DeclareLaunchArgument


def read_arguments(arguments: Sequence[str]) -> dict[str, str]:
    """Return values by name; of two for one name the last counts.

    Raises:
        LaunchError: an argument is not of the form ``name:=value``.
    """
    found = {}
    for each in arguments:
        name, assigned, value = each.partition(":=")
        if not assigned or not name:
            raise LaunchError(f"malformed launch argument '{each}', expected format '<name>:=<value>'")
        found[name] = value
    return found


def describe_arguments(path: Path) -> str:
    """Return what ``ros2 launch FILE --show-args`` prints: the arguments of a file and its included files.

    Raises:
        LaunchError: the file cannot be read.
    """
    lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
    declared: dict[str, DeclareLaunchArgument] = {}
    for each in load_description(path).get_launch_arguments():
        declared.setdefault(each.name, each)
    for each in declared.values():
        lines += ["", f"    '{each.name}':", f"        {each.description}"]
        if each.default_value is not None:
            lines.append(f"        (default: {' + '.join(part.describe() for part in each.default_value)})")
    if len(lines) == 1:
        lines += ["", "  No arguments."]
    return "\n".join(lines)
